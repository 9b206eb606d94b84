; After k of at most 97 steps of up to 4 m in all, a sample is within 0.2 mm of its exact place, chords apart.
; Requirements: GUARD-21
;
; Per step and axis: 0.5 counts of 2^-12 mm rounding, sine off by 440 counts of 2^-30 (angles::sine_and_cosine), chord rounded up
; by at most one count; heading off by 2 k times 1.4 counts of 2^-32 turn (angles::half_turn_of_a_step), 2.1e-9 rad each.
(set-logic QF_NRA)
(declare-const k Real)
(declare-const path Real)
(declare-const ex Real)
(declare-const heading Real)
(assert (and (<= 0 k) (<= k 97) (<= 0 path) (<= path 4000)))
(assert (<= heading (* 2 k 0.0000000021)))
(assert (<= ex (+ (* k (/ 1.5 4096)) (* path (/ 440 1073741824)) (* path heading))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (* 1.4143 ex) 0.2)))
(check-sat)
