; False twin: the new ramp may take as long as a whole old one.
; Requirements: BRAKE-02
;
; Satisfiable, or the lemma shows nothing.
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
(assert (and (<= 0 left) (<= left tb)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ s (/ (* v left) 2)) (/ (* v0 tb) 2))))
(check-sat)
