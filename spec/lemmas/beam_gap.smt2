; Between two returns of a disc at most g apart its surface rises above their segment by at most g/2.
; Requirements: GUARD-15 GUARD-14
;
; R: radius, at least g/2 (A-WIDTH); c: distance of the returns; h: height of the arc between them, the smaller one.
(set-logic QF_NRA)
(declare-const R Real)
(declare-const c Real)
(declare-const g Real)
(declare-const h Real)
(assert (and (> R 0) (>= R (/ g 2)) (<= 0 c) (<= c g)))
(assert (and (<= 0 h) (<= h R)))
(assert (= (+ (* (- R h) (- R h)) (/ (* c c) 4)) (* R R)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= h (/ g 2))))
(check-sat)
