; A speed ramp that takes the slower of two times covers v t_b / 2; both parts reach rest within it.
; Requirements: BRAKE-03 BRAKE-05
;
; g: common factor of v and omega at time t of a ramp of length tb = max(v/b, omega/beta).
(set-logic QF_NRA)
(declare-const v Real)
(declare-const w Real)
(declare-const b Real)
(declare-const beta Real)
(declare-const tb Real)
(declare-const t Real)
(declare-const g Real)
(assert (and (>= v 0) (>= w 0) (> b 0) (> beta 0) (>= t 0) (<= t tb)))
(assert (and (>= (* b tb) v) (>= (* beta tb) w)))
(assert (and (> tb 0) (= (* g tb) (- tb t))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (and (<= (* v (- 1 g)) (* b t)) (<= (* w (- 1 g)) (* beta t)))))
(check-sat)
