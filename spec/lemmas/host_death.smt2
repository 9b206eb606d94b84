; After the host has died the robot drives at most v t_w + v^2 / (2 b).
; Requirements: SILENT-05 GUARD-12
;
; It goes on at up to v for at most tw, then brakes with d >= b for time t until v - d t >= 0.
(set-logic QF_NRA)
(declare-const v Real)
(declare-const x Real)
(declare-const tw Real)
(declare-const d Real)
(declare-const b Real)
(declare-const t Real)
(assert (and (>= v 0) (>= tw 0) (> b 0) (>= d b) (>= t 0) (>= (- v (* d t)) 0)))
(assert (= x (+ (* v tw) (* v t) (- (/ (* d t t) 2)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (* 2 b x) (+ (* 2 b v tw) (* v v)))))
(check-sat)
