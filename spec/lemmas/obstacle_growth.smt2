; A body that moves at most at V is within V (age + latest) of its return whenever the robot is there.
; Requirements: GUARD-07
;
; (x, y): how far a point of the body is from its return; t: when the robot is there, at most latest.
(set-logic QF_NRA)
(declare-const x Real)
(declare-const y Real)
(declare-const V Real)
(declare-const age Real)
(declare-const t Real)
(declare-const latest Real)
(assert (and (>= V 0) (>= age 0) (>= t 0) (<= t latest)))
(assert (<= (+ (* x x) (* y y)) (* V V (+ age t) (+ age t))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (and (<= x (* V (+ age latest))) (<= (- x) (* V (+ age latest))) (<= y (* V (+ age latest))))))
(check-sat)
