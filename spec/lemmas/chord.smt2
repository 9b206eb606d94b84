; Taking the arc for the chord is wrong by at most s th^2/24, and at 5 degrees a step by less than s/2048.
; Requirements: GUARD-21
;
; c: chord of an arc s that turns by th, with sin(x) >= x - x^3/6 (intervals::sine_below); th in radians.
(set-logic QF_NRA)
(declare-const s Real)
(declare-const th Real)
(declare-const c Real)
(assert (and (>= s 0) (<= 0 th) (<= th 0.087267)))
(assert (<= c s))
(assert (>= c (* s (- 1 (/ (* th th) 24)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (- s c) (/ s 2048))))
(check-sat)
