; False twin: 0.02 mm.
; Requirements: GUARD-21
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const k Real)
(declare-const path Real)
(declare-const ex Real)
(declare-const heading Real)
(assert (and (<= 0 k) (<= k 97) (<= 0 path) (<= path 4000)))
(assert (<= heading (* 2 k 0.0000000021)))
(assert (<= ex (+ (* k (/ 1.5 4096)) (* path (/ 440 1073741824)) (* path heading))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (* 1.4143 ex) 0.02)))
(check-sat)
