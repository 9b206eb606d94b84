; Accelerating for one period and then braking is no farther than the tube planned with the higher speed.
; Requirements: BRAKE-02 LIMIT-04
;
; v: speed now; a: acceleration at most A for a period p; the plan counts the higher speed vhi for the whole period.
(set-logic QF_NRA)
(declare-const v Real)
(declare-const a Real)
(declare-const A Real)
(declare-const p Real)
(declare-const vhi Real)
(declare-const b Real)
(assert (and (>= v 0) (<= 0 a) (<= a A) (>= p 0) (> b 0)))
(assert (= vhi (+ v (* A p))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ (* 2 b (+ (* v p) (/ (* a p p) 2))) (* (+ v (* a p)) (+ v (* a p)))) (+ (* 2 b vhi p) (* vhi vhi)))))
(check-sat)
