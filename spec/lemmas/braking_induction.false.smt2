; False twin: the brakes may give a tenth less than b.
; Requirements: BRAKE-02
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const x Real)
(declare-const v Real)
(declare-const d Real)
(declare-const b Real)
(declare-const dt Real)
(declare-const x2 Real)
(declare-const v2 Real)
(assert (and (>= v 0) (> b 0) (> dt 0) (>= d (* 0.9 b))))
(assert (= v2 (- v (* d dt))))
(assert (>= v2 0))
(assert (= x2 (+ x (* v dt) (- (/ (* d dt dt) 2)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (+ (* 2 b x2) (* v2 v2)) (+ (* 2 b x) (* v v)))))
(check-sat)
