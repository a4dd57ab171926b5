#!/usr/bin/python3
"""Times the action service of policy_node while a model is being solved.

Starts a node of its own on the running master, loads a policy of random vectors, gives it a solve that takes as
long as the measurement, and prints the median and the 95th percentile of a call, for dense and for sparse beliefs,
over persistent connections and over one connection a call. Times hold the client's part: Python, and the wire.
"""
import argparse
import json
import os
import random
import signal
import subprocess
import sys
import time
from typing import Callable, Dict, List

import actionlib
import rospy
from kr3_msgs.msg import SolveAction, SolveFeedback, SolveGoal, Status
from kr3_msgs.srv import (
    AdvanceBelief,
    AdvanceBeliefRequest,
    CreateBelief,
    GetPolicyAction,
    GetPolicyActionRequest,
    LoadPolicy,
)

_NAMESPACE = "latency"
_HEADLINE = "get_action, dense, persistent"  # the figure of the goals


def ring(size: int) -> str:
    """A noisy ring of places of which one in `size` pays: a model that is never solved to the end."""
    lines = ["discount: 0.99", "values: reward", f"states: {size}", "actions: 3", "observations: 2"]
    for s in range(size):
        for a, (left, right) in enumerate([(0.6, 0.2), (0.2, 0.6), (0.1, 0.1)]):
            lines.append(f"T: {a} : {s} : {(s - 1) % size} {left}")
            lines.append(f"T: {a} : {s} : {(s + 1) % size} {right}")
            lines.append(f"T: {a} : {s} : {s} {1 - left - right:.3f}")
        seen = 0.5 + 0.4 * ((s * s) % 7 == 1)
        lines.append(f"O: * : {s} : 0 {seen}")
        lines.append(f"O: * : {s} : 1 {1 - seen:.3f}")
        lines.append(f"R: 2 : {s} : * : * {10 if s == 0 else -1}")
    return "\n".join(lines) + "\n"


def random_policy(states: int, vectors: int, rng: random.Random) -> str:
    """A policy over all states in KR3's format."""
    lines = ["kr3_policy 1", f"states {states}", f"vectors {vectors}"]
    for v in range(vectors):
        values = " ".join(f"{rng.uniform(-1.0, 1.0):.6f}" for _ in range(states))
        lines.append(f"{v % 3} 0 {values}")
    return "\n".join(lines) + "\n"


def random_belief(size: int, rng: random.Random) -> List[float]:
    weights = [rng.random() + 1e-6 for _ in range(size)]
    total = sum(weights)
    return [weight / total for weight in weights]


def checked(response):
    """The response, if it is good."""
    if response.status.code != Status.OK:
        raise RuntimeError(response.status.message)
    return response


def cpu_seconds(process: int) -> float:
    """CPU time of a process so far."""
    with open(f"/proc/{process}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def timed(call: Callable[[], object], count: int, node: int) -> Dict[str, float]:
    """Percentiles of the wall time of a call, and the node's CPU time for one, in milliseconds."""
    times = []
    cpu_before_s = cpu_seconds(node)
    for _ in range(count):
        start = time.perf_counter()
        checked(call())
        times.append(1e3 * (time.perf_counter() - start))
    times.sort()
    return {
        "node_cpu_ms": 1e3 * (cpu_seconds(node) - cpu_before_s) / count,
        "p50_ms": times[len(times) // 2],
        "p95_ms": times[int(0.95 * (len(times) - 1))],
        "max_ms": times[-1],
    }


def proxy(name: str, kind, persistent: bool = True):
    full = f"/{_NAMESPACE}/pomdp/{name}"
    rospy.wait_for_service(full, timeout=20)
    return rospy.ServiceProxy(full, kind, persistent=persistent)


def start_solving(stop_after_s: float) -> actionlib.SimpleActionClient:
    client = actionlib.SimpleActionClient(f"/{_NAMESPACE}/pomdp/solve", SolveAction)
    if not client.wait_for_server(rospy.Duration(20)):
        raise RuntimeError("no action server")
    phases: List[int] = []
    client.send_goal(
        SolveGoal(model=ring(200), precision=1e-9, time_limit=rospy.Duration(stop_after_s)),
        feedback_cb=lambda feedback: phases.append(feedback.phase),
    )
    deadline = time.monotonic() + 20.0
    while SolveFeedback.SOLVING not in phases:
        if time.monotonic() > deadline:
            raise RuntimeError("the solve did not begin")
        client.wait_for_result(rospy.Duration(0.05))
    return client


def measure(args: argparse.Namespace, node: int) -> Dict[str, Dict[str, float]]:
    rng = random.Random(args.seed)
    load = proxy("load_policy", LoadPolicy)
    policy = checked(
        load(
            load.request_class(
                model=ring(args.states), policy=random_policy(args.states, args.vectors, rng)
            )
        )
    ).policy_id
    dense = GetPolicyActionRequest(policy_id=policy, belief=random_belief(args.states, rng))
    support = sorted(rng.sample(range(args.states), min(50, args.states)))
    sparse = GetPolicyActionRequest(
        policy_id=policy, belief=random_belief(len(support), rng), states=support
    )
    create = proxy("create_belief", CreateBelief)
    kept = checked(create(create.request_class(policy_id=policy))).belief_id
    step = AdvanceBeliefRequest(belief_id=kept, action="2", observation="0")
    solving = None if args.idle else start_solving(60.0)
    results = {}
    for persistent in (True, False):
        label = "persistent" if persistent else "one connection a call"
        count = args.calls if persistent else args.calls // 4
        get_action = proxy("get_action", GetPolicyAction, persistent)
        advance = proxy("advance_belief", AdvanceBelief, persistent)
        results[f"get_action, sparse (50 states), {label}"] = timed(
            lambda: get_action(sparse), count, node
        )
        results[f"get_action, dense, {label}"] = timed(lambda: get_action(dense), count, node)
        results[f"advance_belief, {label}"] = timed(lambda: advance(step), count, node)
    if solving is not None:
        solving.cancel_goal()
        solving.wait_for_result(rospy.Duration(10))
    return results


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--vectors", type=int, default=2000)
    parser.add_argument("--calls", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--idle", action="store_true", help="without a solve under way")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    args = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("policy_node_latency", disable_signals=True)
    node = subprocess.Popen(
        ["rosrun", "kr3_pomdp", "policy_node", f"__ns:={_NAMESPACE}", "_cache_megabytes:=1024"],
        stdout=sys.stderr,
    )
    try:
        results = measure(args, node.pid)
    finally:
        node.send_signal(signal.SIGINT)
        node.wait(timeout=20)
    if args.json:
        print(json.dumps({"p50_ms": results[_HEADLINE]["p50_ms"], "cases": results}, indent=2))
        return 0
    print(
        f"{args.vectors} vectors over {args.states} states"
        + ("" if args.idle else ", solving meanwhile")
    )
    for name, row in results.items():
        figures = [
            f"p50 {row['p50_ms']:7.3f}",
            f"p95 {row['p95_ms']:7.3f}",
            f"max {row['max_ms']:7.3f}",
        ]
        if args.idle:  # else it holds the solver's
            figures.append(f"the node's CPU {row['node_cpu_ms']:6.3f}")
        print(f"{name:58s} {', '.join(figures)} ms")
    return 0


if __name__ == "__main__":
    sys.exit(main())
