; Half the arc path of a corner between two samples suffices: one of the two covers every place between them.
; Requirements: GUARD-05 GUARD-06
;
; u: how far between the samples (0 to 1); hc: arc path of a corner between them; e0, e1: inflation at the samples, e at u,
; convex and not falling.
(set-logic QF_NRA)
(declare-const u Real)
(declare-const hc Real)
(declare-const e0 Real)
(declare-const e1 Real)
(declare-const e Real)
(assert (and (<= 0 u) (<= u 1) (>= hc 0) (>= e0 0) (<= e0 e) (<= e e1)))
(assert (<= e (+ (* (- 1 u) e0) (* u e1))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (or (<= (+ (* u hc) e) (+ e0 (/ hc 2))) (<= (+ (* (- 1 u) hc) e) (+ e1 (/ hc 2))))))
(check-sat)
