; False twin: a quarter of the arc path.
; Requirements: GUARD-05 GUARD-06
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const u Real)
(declare-const hc Real)
(declare-const e0 Real)
(declare-const e1 Real)
(declare-const e Real)
(assert (and (<= 0 u) (<= u 1) (>= hc 0) (>= e0 0) (<= e0 e) (<= e e1)))
(assert (<= e (+ (* (- 1 u) e0) (* u e1))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (or (<= (+ (* u hc) e) (+ e0 (/ hc 4))) (<= (+ (* (- 1 u) hc) e) (+ e1 (/ hc 4))))))
(check-sat)
