; A braking step never lengthens the path to rest: x + v^2/(2b) does not grow while the deceleration is at least b.
; Requirements: BRAKE-02
;
; x, v: path and speed now; d: deceleration during dt; b: sure deceleration (A-BRAKE).
; Both sides times 2b, so that nothing is divided.
(set-logic QF_NRA)
(declare-const x Real)
(declare-const v Real)
(declare-const d Real)
(declare-const b Real)
(declare-const dt Real)
(declare-const x2 Real)
(declare-const v2 Real)
(assert (and (>= v 0) (> b 0) (> dt 0) (>= d b)))
(assert (= v2 (- v (* d dt))))
(assert (>= v2 0))
(assert (= x2 (+ x (* v dt) (- (/ (* d dt dt) 2)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ (* 2 b x2) (* v2 v2)) (+ (* 2 b x) (* v v)))))
(check-sat)
