; False twin: the hold time is exceeded by a tenth.
; Requirements: BRAKE-02 GUARD-05
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const s Real)
(declare-const v Real)
(declare-const vhi Real)
(declare-const t Real)
(declare-const T Real)
(declare-const tb Real)
(declare-const tb2 Real)
(assert (and (<= 0 v) (<= v vhi) (<= 0 t) (<= t (* 1.1 T))))
(assert (and (<= 0 s) (<= s (* vhi t))))
(assert (and (<= 0 tb2) (<= tb2 tb)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ s (/ (* v tb2) 2)) (* vhi (+ T (/ tb 2))))))
(check-sat)
