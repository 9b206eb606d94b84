; Braking at any moment of the hold time ends no farther than the tube: s + v t_b'/2 <= v_hi (T + t_b/2).
; Requirements: BRAKE-02 GUARD-05
;
; s, v: path and speed after t <= T at speeds up to vhi; tb2: time of a joint ramp from there, at most tb.
(set-logic QF_NRA)
(declare-const s Real)
(declare-const v Real)
(declare-const vhi Real)
(declare-const t Real)
(declare-const T Real)
(declare-const tb Real)
(declare-const tb2 Real)
(assert (and (<= 0 v) (<= v vhi) (<= 0 t) (<= t T)))
(assert (and (<= 0 s) (<= s (* vhi t))))
(assert (and (<= 0 tb2) (<= tb2 tb)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ s (/ (* v tb2) 2)) (* vhi (+ T (/ tb 2))))))
(check-sat)
