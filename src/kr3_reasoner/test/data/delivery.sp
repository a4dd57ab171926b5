#const n = 4.
sorts
#room = [room][1..3].
#robot = {rob1}.
#cup = {mug}.
#thing = #robot + #cup.
#step = 0..n.
#inertial_fluent = loc(#thing, #room) + holding(#robot, #cup).
#defined_fluent = busy(#robot).
#fluent = #inertial_fluent + #defined_fluent.
#action = go(#robot, #room) + take(#robot, #cup) + swap(#room(X), #room(Y)):X!=Y.
predicates
next_to(#room, #room).
holds(#fluent, #step).
occurs(#action, #step).
success().
goal(#step).
rules
% causal laws
holds(loc(R, P), I+1) :- occurs(go(R, P), I).
holds(holding(R, C), I+1) :- occurs(take(R, C), I), I < n.
% state constraints
-holds(loc(T, P2), I) :- holds(loc(T, P1), I), P1 != P2.
holds(loc(C, P), I) :- holds(loc(R, P), I), holds(holding(R, C), I).
holds(busy(R), I) :- holds(holding(R, C), I), #cup(C).
% executability
-occurs(go(R, P2), I) :- holds(loc(R, P1), I), -next_to(P1, P2).
-occurs(take(R, C), I) :- holds(loc(R, P1), I), holds(loc(C, P2), I), P1 != P2.
-occurs(take(R, C), I) :- holds(busy(R), I).
:- occurs(A1, I), occurs(A2, I), A1 != A2.
next_to(room1, room2).
next_to(room2, room3).
next_to(P1, P2) :- next_to(P2, P1).
-next_to(P1, P2) :- not next_to(P1, P2).
% inertia and closed worlds
holds(F, I+1) :- #inertial_fluent(F), holds(F, I), not -holds(F, I+1).
-holds(F, I+1) :- #inertial_fluent(F), -holds(F, I), not holds(F, I+1).
-holds(F, I) :- #defined_fluent(F), not holds(F, I).
-occurs(A, I) :- not occurs(A, I).
% start, goal and planning
holds(loc(rob1, room1), 0).
holds(loc(mug, room3), 0).
-holds(holding(rob1, mug), 0).
goal(I) :- holds(loc(mug, room1), I).
success :- goal(I).
:- not success.
occurs(A, I) | -occurs(A, I) :- not goal(I).
