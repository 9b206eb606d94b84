; Turning an offset up to 5793 mm moves it by at most 0.31 mm: rounding of the table's components and of the result.
; Requirements: GUARD-21
;
; Components off by at most 0.514/32768 (angles::rotation_fits), results rounded down to eighths of a millimetre.
(set-logic QF_NRA)
(declare-const x Real)
(declare-const y Real)
(declare-const c Real)
(declare-const s Real)
(declare-const ec Real)
(declare-const es Real)
(declare-const r Real)
(assert (and (<= (- 5793) x) (<= x 5793) (<= (- 5793) y) (<= y 5793)))
(assert (and (<= (- 0.0000157) ec) (<= ec 0.0000157) (<= (- 0.0000157) es) (<= es 0.0000157)))
(assert (and (<= 0 r) (<= r 0.125)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (let ((e (- (+ (* ec x) (* es y)) r))) (and (<= e 0.31) (<= (- e) 0.31)))))
(check-sat)
