; False twin: the turn rate has no say in the length of the ramp.
; Requirements: BRAKE-03 BRAKE-05
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const v Real)
(declare-const w Real)
(declare-const b Real)
(declare-const beta Real)
(declare-const tb Real)
(declare-const t Real)
(declare-const g Real)
(assert (and (>= v 0) (>= w 0) (> b 0) (> beta 0) (>= t 0) (<= t tb)))
(assert (>= (* b tb) v))
(assert (and (> tb 0) (= (* g tb) (- tb t))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (and (<= (* v (- 1 g)) (* b t)) (<= (* w (- 1 g)) (* beta t)))))
(check-sat)
