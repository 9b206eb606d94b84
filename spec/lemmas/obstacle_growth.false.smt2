; False twin: the age of the return is left out.
; Requirements: GUARD-07
;
; Satisfiable, or the lemma shows nothing.
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
(assert (not (<= x (* V latest))))
(check-sat)
