; False twin: the corner is left out of the curvature term.
; Requirements: GUARD-08
;
; Satisfiable, or the lemma shows nothing.
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
(assert (not (<= (+ p2 (* rho (+ (* dk (+ s ds)) w))) (+ (* dk (/ (* (+ s ds) (+ s ds)) 2)) (* w (+ s ds rho))))))
(check-sat)
