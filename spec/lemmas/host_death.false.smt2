; False twin: the watchdog takes no time.
; Requirements: SILENT-05 GUARD-12
;
; Satisfiable, or the lemma shows nothing.
(set-logic QF_NRA)
(declare-const v Real)
(declare-const x Real)
(declare-const tw Real)
(declare-const d Real)
(declare-const b Real)
(declare-const t Real)
(assert (and (>= v 0) (>= tw 0) (> b 0) (>= d b) (>= t 0) (>= (- v (* d t)) 0)))
(assert (= x (+ (* v tw) (* v t) (- (/ (* d t t) 2)))))
; The negation of what is claimed: unsatisfiable if it holds.
(assert (not (<= (* 2 b x) (* v v))))
(check-sat)
