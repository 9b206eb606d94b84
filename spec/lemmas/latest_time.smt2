; The latest time at path s: with v0 t^2 <= 2 s (C v0 + a) and t <= C v0 + a follows (t - a)^2 <= 2 C s.
; Requirements: GUARD-07
;
; t: time since braking began, beyond a = tol_w / beta; the ramp falls at a rate of at least 1/t_b, t_b <= C v0 + a.
(set-logic QF_NRA)
(declare-const t Real)
(declare-const s Real)
(declare-const v0 Real)
(declare-const C Real)
(declare-const a Real)
(assert (and (>= s 0) (>= v0 0) (> C 0) (>= a 0) (>= t a)))
(assert (<= t (+ (* C v0) a)))
(assert (<= (* v0 t t) (* 2 s (+ (* C v0) a))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (* (- t a) (- t a)) (* 2 C s))))
(check-sat)
