; A robot on its ramp to rest that begins a new ramp stays within the old one's path, however late it begins.
; Requirements: BRAKE-02
;
; Old ramp: speed v0 falls linearly in tb. After u it has driven s at speed v. A new joint ramp from there
; takes at most what the old one has left, since v/b and omega/beta shrink with the common factor g.
(set-logic QF_NRA)
(declare-const v0 Real)
(declare-const tb Real)
(declare-const u Real)
(declare-const s Real)
(declare-const g Real)
(declare-const v Real)
(declare-const left Real)
(assert (and (>= v0 0) (> tb 0) (<= 0 u) (<= u tb)))
(assert (= (* g tb) (- tb u)))
(assert (= v (* g v0)))
(assert (= s (/ (* (+ v0 v) u) 2)))
(assert (and (<= 0 left) (<= left (* g tb))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ s (/ (* v left) 2)) (/ (* v0 tb) 2))))
(check-sat)
