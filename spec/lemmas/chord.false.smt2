; False twin: half of that.
; Requirements: GUARD-21
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const s Real)
(declare-const th Real)
(declare-const c Real)
(assert (and (>= s 0) (<= 0 th) (<= th 0.087267)))
(assert (<= c s))
(assert (>= c (* s (- 1 (/ (* th th) 24)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (- s c) (/ s 4096))))
(check-sat)
