; A motion between two of a hull, off by the tolerances, has a curvature of the interval up to the residual turn rate.
; Requirements: GUARD-08 GUARD-03
;
; (v1,w1), (v2,w2): motions within r of [lo v, hi v]; l: weight; dv, dw: tolerances; k bounds |lo| and |hi|.
(set-logic QF_NRA)
(declare-const v1 Real)
(declare-const w1 Real)
(declare-const v2 Real)
(declare-const w2 Real)
(declare-const lo Real)
(declare-const hi Real)
(declare-const r Real)
(declare-const l Real)
(declare-const v Real)
(declare-const w Real)
(declare-const dv Real)
(declare-const dw Real)
(declare-const tv Real)
(declare-const tw Real)
(declare-const k Real)
(assert (and (<= (- (* lo v1) r) w1) (<= w1 (+ (* hi v1) r))))
(assert (and (<= (- (* lo v2) r) w2) (<= w2 (+ (* hi v2) r))))
(assert (and (<= 0 l) (<= l 1) (<= lo hi) (<= (- k) lo) (<= hi k) (<= lo k) (<= (- k) hi)))
(assert (= v (+ (* l v1) (* (- 1 l) v2) dv)))
(assert (= w (+ (* l w1) (* (- 1 l) w2) dw)))
(assert (and (<= (- tv) dv) (<= dv tv) (<= (- tw) dw) (<= dw tw)))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (and (<= (- (* lo v) tw (* k tv) r) w) (<= w (+ (* hi v) tw (* k tv) r)))))
(check-sat)
