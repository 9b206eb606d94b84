; The spread at equal arc length grows as the model says: one step of any length keeps e(s) = dk (s^2/2 + rho s) + w (s + rho).
; Requirements: GUARD-08
;
; p: distance of the rotation centres at s; the headings differ by at most dk s + w there (w = tol_w t_max), so over a
; step ds the centres part by at most its mean times ds, and a corner at rho adds rho times the difference at its end.
(set-logic QF_NRA)
(declare-const dk Real)
(declare-const w Real)
(declare-const s Real)
(declare-const ds Real)
(declare-const rho Real)
(declare-const p Real)
(declare-const p2 Real)
(assert (and (>= dk 0) (>= w 0) (>= s 0) (>= ds 0) (>= rho 0)))
(assert (<= p (+ (/ (* dk s s) 2) (* w s))))
(assert (<= p2 (+ p (* ds (+ (* dk (+ s (/ ds 2))) w)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ p2 (* rho (+ (* dk (+ s ds)) w))) (+ (* dk (+ (/ (* (+ s ds) (+ s ds)) 2) (* rho (+ s ds)))) (* w (+ s ds rho))))))
(check-sat)
