"""The rooms x objects fetch plan as one answer set program, translated literally, for comparison.

Classical negation for every fluent, a constraint for each pair of values, the closure of what is known
initially on a layer of its own, everything grounded and solved at one go. This is what the paper's
translation comes to, and what the reasoner is measured against.
"""

from rooms_domain import Size

RULES = """
step(0..n).
object(X) :- textbook(X).  object(parcel).
thing(X) :- object(X).  thing(X) :- robot(X).
inertial(loc(T,P)) :- thing(T), place(P).
inertial(in_hand(R,O)) :- robot(R), object(O).
action(move(R,P)) :- robot(R), place(P).
action(grasp(R,O)) :- robot(R), object(O).
action(putdown(R,O)) :- robot(R), object(O).

% Closure: known and -known are founded, apart from the states.
known(F) :- init(F).
-known(F) :- -init(F).
-known(F) :- exception(F).
-known(loc(T,P1)) :- known(loc(T,P2)), place(P1), P1 != P2.
known(loc(O,P)) :- known(loc(R,P)), known(in_hand(R,O)).
known(loc(X,main_library)) :- textbook(X), not -known(loc(X,main_library)).
known(loc(X,aux_library)) :- textbook(X), -known(loc(X,main_library)), not -known(loc(X,aux_library)).
known(loc(X,office)) :- textbook(X), -known(loc(X,main_library)), -known(loc(X,aux_library)),
    not -known(loc(X,office)).
{ exception(loc(X,main_library)); exception(loc(X,aux_library)); exception(loc(X,office)) } :- textbook(X).
holds(F,0) :- known(F).
-holds(F,0) :- -known(F).
1 { holds(F,0); -holds(F,0) } 1 :- inertial(F).

% States and transitions.
-holds(loc(T,P1),I) :- holds(loc(T,P2),I), place(P1), P1 != P2.
:- thing(T), step(I), not 1 { holds(loc(T,P),I) : place(P) }.
holds(loc(O,P),I) :- holds(loc(R,P),I), holds(in_hand(R,O),I).
holds(F,I+1) :- inertial(F), holds(F,I), not -holds(F,I+1), I < n.
-holds(F,I+1) :- inertial(F), -holds(F,I), not holds(F,I+1), I < n.
holds(loc(R,P),I+1) :- occurs(move(R,P),I), I < n.
holds(in_hand(R,O),I+1) :- occurs(grasp(R,O),I), I < n.
-holds(in_hand(R,O),I+1) :- occurs(putdown(R,O),I), I < n.
:- occurs(move(R,P),I), holds(loc(R,P),I).
:- occurs(grasp(R,O),I), holds(loc(R,P1),I), holds(loc(O,P2),I), P1 != P2.
:- occurs(grasp(R,O),I), holds(in_hand(R,O),I).
:- occurs(putdown(R,O),I), -holds(in_hand(R,O),I).

% The plan. Exceptions come first; the plan has exactly n steps.
1 { occurs(A,I) : action(A) } 1 :- step(I), I < n.
:- not holds(loc(tb1,corner),n).
:- not -holds(in_hand(rob1,tb1),n).
:~ exception(F). [1@2,F]
#show occurs/2.
"""


def fetch_plan(size: Size, length: int) -> str:
    """The program of a plan of `length` steps from the start of rooms_domain.start."""
    facts = [f"#const n = {length}.", "robot(rob1).", "init(loc(rob1,study))."]
    facts += [f"place({place})." for place in size.places]
    facts += [f"textbook({book})." for book in size.books]
    facts += [f"-init(in_hand(rob1,{book}))." for book in [*size.books, "parcel"]]
    return "\n".join(facts) + RULES
