; False twin: a quarter of the gap.
; Requirements: GUARD-15 GUARD-14
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const R Real)
(declare-const c Real)
(declare-const g Real)
(declare-const h Real)
(assert (and (> R 0) (>= R (/ g 2)) (<= 0 c) (<= c g)))
(assert (and (<= 0 h) (<= h R)))
(assert (= (+ (* (- R h) (- R h)) (/ (* c c) 4)) (* R R)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= h (/ g 4))))
(check-sat)
