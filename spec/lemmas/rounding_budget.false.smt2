; False twin: 2.5 mm.
; Requirements: GUARD-21 GUARD-06
;
; Millimetres along one axis of the sample's frame: decoding a range 0.501; storing 0.515 a component (half a unit, and
; 440 counts of 2^-30 at 32 m); the body frame 0.683 a component (half a unit, and the table's components at 5.8 m);
; the sample's centre rounded down to an eighth 0.125 a component; turning into the sample's frame 0.31
; (lemma::rotation); the recurrence 0.2 (lemma::recurrence). What two components may do together is 1.4143 times as much.
(set-logic QF_NRA)
(declare-const decode Real)
(declare-const store Real)
(declare-const body Real)
(declare-const centre Real)
(declare-const sample Real)
(declare-const walk Real)
(assert (and (<= decode 0.501) (<= store (* 1.4143 0.515)) (<= body (* 1.4143 0.683))))
(assert (and (<= centre (* 1.4143 0.125)) (<= sample 0.31) (<= walk 0.2)))
; The negation of what is claimed: satisfiable, or the lemma shows nothing.
(assert (not (<= (+ decode store body centre sample walk) 2.5)))
(check-sat)
