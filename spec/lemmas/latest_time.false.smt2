; False twin: the residual turn rate takes no time.
; Requirements: GUARD-07
;
; Satisfiable, or the lemma shows nothing.
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
(assert (not (<= (* t t) (* 2 C s))))
(check-sat)
