#!/usr/bin/python3
"""Contract of policy_node's services: policies and beliefs by handle, files, planning online."""
import threading
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from kr3_msgs.msg import SolveFeedback, Status
from kr3_msgs.srv import SavePolicyRequest
from policy_node_support import SWITCH_POMDPX, TIGER, Goal, Services, maze, solved

MAX_BELIEFS = 20  # as in policy_node.test

CERTAIN = """
discount: 0.9
values: reward
states: near far
actions: look go
observations: n f
start: near
T: look identity
T: go
0 1
1 0
O: *
1 0
0 1
R: go : near : * : * 1
"""


class PolicyNodeServicesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.services = Services()

    def assert_code(self, code, response, said=""):
        self.assertEqual(response.status.code, code, response.status.message)
        self.assertIn(said, response.status.message)
        return response

    def assert_ok(self, response):
        return self.assert_code(Status.OK, response)

    def test_keeps_a_belief_for_the_robot(self):
        policy = solved()
        belief = self.assert_ok(self.services.create_belief(policy_id=policy))
        self.assertEqual((belief.version, belief.has_action, belief.action), (1, True, "listen"))
        name = belief.belief_id
        step = {"belief_id": name, "action": "listen", "observation": "hear_left"}
        first = self.assert_ok(self.services.advance_belief(version=1, **step))
        self.assertEqual((first.version, first.next_action), (2, "listen"))
        self.assertAlmostEqual(first.probability, 0.5)
        # A call that is tried again does not count twice.
        self.assert_code(
            Status.FAILED_PRECONDITION, self.services.advance_belief(version=1, **step), "version 2"
        )
        second = self.assert_ok(self.services.advance_belief(**step))
        self.assertEqual((second.version, second.next_action), (3, "open_right"))
        now = self.assert_ok(self.services.get_belief(belief_id=name))
        self.assertEqual((now.policy_id, now.version, tuple(now.states)), (policy, 3, (0, 1)))
        self.assertAlmostEqual(now.belief[0], 0.85**2 / (0.85**2 + 0.15**2))
        most = self.assert_ok(self.services.get_belief(belief_id=name, max_states=1))
        self.assertEqual(tuple(most.states), (0,))
        dense = self.assert_ok(self.services.get_belief(belief_id=name, dense=True))
        self.assertEqual((tuple(dense.states), dense.belief), ((), now.belief))
        reset = self.assert_ok(self.services.reset_belief(belief_id=name))
        self.assertEqual((reset.version, reset.action), (4, "listen"))
        self.assert_ok(self.services.reset_belief(belief_id=name, belief=[1.0], states=[1]))
        self.assertEqual(self.services.get_belief(belief_id=name).action, "open_left")
        listed = self.assert_ok(self.services.list_beliefs(policy_id=policy))
        self.assertIn(name, [b.belief_id for b in listed.beliefs])
        self.assert_ok(self.services.delete_belief(belief_id=name))
        self.assert_code(Status.NOT_FOUND, self.services.get_belief(belief_id=name), "was deleted")

    def test_refuses_bad_beliefs_and_names(self):
        policy = solved()
        nan = float("nan")
        bad = [[nan, 1.0], [-0.5, 1.5], [0.0, 0.0], [0.5, 0.6], [1.0], [0.5] * 3, [float("inf"), 0]]
        for belief in bad:
            fields = {"policy_id": policy, "belief": belief}
            for response in [
                self.services.get_action(**fields),
                self.services.create_belief(**fields),
                self.services.update_belief(action="listen", observation="hear_left", **fields),
            ]:
                self.assert_code(Status.INVALID_ARGUMENT, response)
        for states in [[0, 2], [1, 0], [0, 0], [0]]:
            self.assert_code(
                Status.INVALID_ARGUMENT,
                self.services.get_action(policy_id=policy, belief=[0.5, 0.5], states=states),
            )
        for action, observation, said in [
            ("lisen", "hear_left", "did you mean 'listen'"),
            ("listen", "hear_lft", "did you mean 'hear_left'"),
            ("", "hear_left", "no action ''"),
            ("x" * 10000, "hear_left", "no action"),
        ]:
            self.assert_code(
                Status.INVALID_ARGUMENT,
                self.services.update_belief(
                    policy_id=policy, belief=[0.5, 0.5], action=action, observation=observation
                ),
                said,
            )
        self.assert_code(
            Status.NOT_FOUND, self.services.get_action(policy_id="nowhere", belief=[0.5, 0.5])
        )
        self.assert_code(Status.NOT_FOUND, self.services.create_belief(policy_id="nowhere"))

    def test_an_impossible_observation_changes_nothing(self):
        policy = solved(model=CERTAIN)
        name = self.services.create_belief(policy_id=policy).belief_id
        self.assert_code(
            Status.FAILED_PRECONDITION,
            self.services.advance_belief(belief_id=name, action="look", observation="f"),
            "impossible",
        )
        self.assertEqual(self.services.get_belief(belief_id=name).version, 1)
        update = self.services.update_belief(
            policy_id=policy, belief=[1.0], states=[0], action="go", observation="f"
        )
        self.assertEqual((tuple(update.states), tuple(update.belief)), ((1,), (1.0,)))

    def test_sparse_and_dense_are_the_same(self):
        policy = solved(model=maze(30), precision=0.5, max_backups=200)
        dense = [0.0] * 30
        dense[3], dense[7], dense[8] = 0.5, 0.25, 0.25
        sparse = {"belief": [0.5, 0.25, 0.25], "states": [3, 7, 8]}
        a = self.assert_ok(self.services.get_action(policy_id=policy, belief=dense))
        b = self.assert_ok(self.services.get_action(policy_id=policy, **sparse))
        self.assertEqual((a.action, a.value), (b.action, b.value))
        step = {"policy_id": policy, "action": "0", "observation": "1"}
        a = self.assert_ok(self.services.update_belief(belief=dense, **step))
        b = self.assert_ok(self.services.update_belief(**sparse, **step))
        self.assertEqual(a.probability, b.probability)
        self.assertEqual({s: p for s, p in enumerate(a.belief) if p}, dict(zip(b.states, b.belief)))

    def test_sees_part_of_the_state_at_first(self):
        policy = solved(model=SWITCH_POMDPX)
        self.assert_code(
            Status.INVALID_ARGUMENT, self.services.create_belief(policy_id=policy), "first_look"
        )
        belief = self.assert_ok(self.services.create_belief(policy_id=policy, first_look="on,good"))
        now = self.services.get_belief(belief_id=belief.belief_id)
        self.assertEqual(len(now.states), 2)
        self.assertAlmostEqual(now.belief[0], 0.7)

    def test_beliefs_are_bounded_in_number(self):
        policy = solved()
        names = [
            self.assert_ok(self.services.create_belief(policy_id=policy)).belief_id
            for _ in range(MAX_BELIEFS + 1)
        ]
        self.assert_code(
            Status.NOT_FOUND, self.services.get_belief(belief_id=names[0]), "was evicted"
        )
        self.assert_ok(self.services.get_belief(belief_id=names[-1]))
        listed = self.services.list_beliefs()
        self.assertEqual((len(listed.beliefs), listed.max_beliefs), (MAX_BELIEFS, MAX_BELIEFS))
        levels = []
        while not levels:
            message = rospy.wait_for_message("/diagnostics", DiagnosticArray, timeout=10)
            levels = [s for s in message.status if s.name.endswith("policies")]
        self.assertIn(levels[0].level, (1, b"\x01"), str(levels[0]))
        values = {pair.key: pair.value for pair in levels[0].values}
        self.assertGreaterEqual(int(values["evicted beliefs"]), 1)

    def test_lists_describes_and_releases_policies(self):
        policy = solved(model=TIGER.replace("0.95", "0.91"))
        info = self.assert_ok(self.services.get_policy_info(policy_id=policy))
        self.assertEqual(info.states, ["left", "right"])
        self.assertEqual(info.actions, ["listen", "open_left", "open_right"])
        self.assertEqual(info.observations, ["hear_left", "hear_right"])
        self.assertEqual((tuple(info.initial_states), info.initial_belief), ((0, 1), (0.5, 0.5)))
        self.assertEqual((info.summary.num_states, info.summary.stop_reason), (2, "precision"))
        self.assertGreater(info.summary.memory_bytes, 0)
        belief = self.services.create_belief(policy_id=policy).belief_id
        listed = self.assert_ok(self.services.list_policies())
        ours = [p for p in listed.policies if p.policy_id == policy]
        self.assertEqual([p.num_beliefs for p in ours], [1])
        self.assertLessEqual(listed.memory_bytes, listed.max_memory_bytes)
        released = self.assert_ok(self.services.release_policy(policy_id=policy))
        self.assertEqual(released.num_beliefs, 1)
        again = self.services.release_policy(policy_id=policy)
        self.assert_code(Status.NOT_FOUND, again, "was released")
        self.assert_code(Status.NOT_FOUND, self.services.get_belief(belief_id=belief))

    def test_saves_and_loads_policies(self):
        model = TIGER.replace("0.95", "0.9")
        first = Goal(model=model, precision=0.01).result()
        policy = first.policy_id
        saved = self.assert_ok(self.services.save_policy(policy_id=policy, file_name="tiger"))
        self.assertTrue(saved.path.endswith("/tiger"))
        text = self.assert_ok(self.services.save_policy(policy_id=policy)).text
        with open(saved.path, encoding="utf-8") as file:
            self.assertEqual(file.read(), text)
        self.services.release_policy(policy_id=policy)
        loaded = self.assert_ok(self.services.load_policy(file_name="tiger"))
        self.assertEqual(loaded.policy_id, policy)
        self.assertEqual(loaded.summary.upper_bound, first.upper_bound)
        again = Goal(model=model, precision=0.01).result()
        self.assertTrue(again.cached)
        self.assertEqual(self.services.load_policy(bundle=text).policy_id, policy)
        # The policy alone, for the model's text.
        alone = self.services.save_policy(policy_id=policy, format=SavePolicyRequest.POLICY).text
        other = self.assert_ok(self.services.load_policy(model=model, policy=alone))
        self.assertEqual(other.summary.stop_reason, "loaded")
        a = self.services.get_action(policy_id=policy, belief=[0.97, 0.03])
        b = self.services.get_action(policy_id=other.policy_id, belief=[0.97, 0.03])
        self.assertEqual((a.action, a.value), (b.action, b.value))
        appl = self.services.save_policy(policy_id=policy, format=SavePolicyRequest.APPL).text
        theirs = self.assert_ok(self.services.load_policy(model=model, policy=appl))
        c = self.services.get_action(policy_id=theirs.policy_id, belief=[0.97, 0.03])
        self.assertEqual(c.action, a.action)
        self.assertAlmostEqual(c.value, a.value, delta=1e-4)
        for code, fields in [
            (Status.NOT_FOUND, {"file_name": "no_such_file"}),
            (Status.INVALID_ARGUMENT, {"file_name": "../tiger"}),
            (Status.INVALID_ARGUMENT, {"file_name": ".tiger"}),
            (Status.INVALID_ARGUMENT, {"file_name": "tiger", "bundle": text}),
            (Status.INVALID_ARGUMENT, {}),
            (Status.INVALID_ARGUMENT, {"bundle": text.replace("listen", "lissen")}),
            (Status.INVALID_ARGUMENT, {"bundle": text[: len(text) // 2]}),
            (Status.INVALID_ARGUMENT, {"model": maze(5), "policy": alone}),
            (Status.INVALID_ARGUMENT, {"model": model, "policy": "nonsense"}),
        ]:
            self.assert_code(code, self.services.load_policy(**fields))
        for code, fields in [
            (Status.NOT_FOUND, {"policy_id": "nowhere"}),
            (Status.INVALID_ARGUMENT, {"policy_id": policy, "file_name": "a/b"}),
            (Status.INVALID_ARGUMENT, {"policy_id": policy, "format": 77}),
        ]:
            self.assert_code(code, self.services.save_policy(**fields))

    def test_plans_online_for_a_model_without_a_policy(self):
        model = self.assert_ok(self.services.load_policy(model=maze(60))).policy_id
        self.assert_code(
            Status.FAILED_PRECONDITION,
            self.services.get_action(policy_id=model, belief=[1.0], states=[5]),
            "without a policy",
        )
        belief = self.assert_ok(self.services.create_belief(policy_id=model))
        self.assertFalse(belief.has_action)
        budget = {"max_expansions": 200, "num_scenarios": 50, "seed": 3}
        plan = self.assert_ok(self.services.plan_online(belief_id=belief.belief_id, **budget))
        self.assertIn(plan.action, ("0", "1", "2"))
        self.assertEqual(plan.version, 1)
        self.assertLessEqual(plan.lower_bound, plan.upper_bound)
        again = self.assert_ok(self.services.plan_online(policy_id=model, **budget))
        self.assertEqual(
            (again.action, again.lower_bound, again.expansions),
            (plan.action, plan.lower_bound, plan.expansions),
        )
        timed = self.assert_ok(
            self.services.plan_online(
                policy_id=model, belief=[0.5, 0.5], states=[0, 1], time_limit=rospy.Duration(0.2)
            )
        )
        self.assertLess(timed.wall_s, 1.5)
        advanced = self.assert_ok(
            self.services.advance_belief(
                belief_id=belief.belief_id, action=plan.action, observation="1"
            )
        )
        self.assertFalse(advanced.has_action)
        for fields in [
            {"belief_id": belief.belief_id, "policy_id": model},
            {"policy_id": model, "time_limit": rospy.Duration(1000)},
            {"policy_id": model, "time_limit": rospy.Duration(-1)},
            {"policy_id": model, "num_scenarios": 10**9},
        ]:
            self.assert_code(Status.INVALID_ARGUMENT, self.services.plan_online(**fields))

    def test_many_clients_at_a_time_while_solving_and_planning(self):
        policy = solved()
        running = Goal(model=maze(46), precision=1e-9)
        running.wait_for_phase(SolveFeedback.SOLVING)
        failures = []

        def follow(seed):
            services = Services()
            name = services.create_belief(policy_id=policy).belief_id
            left = 0.5
            for i in range(60):
                heard = "hear_left" if (seed * i) % 3 else "hear_right"
                response = services.advance_belief(
                    belief_id=name, action="listen", observation=heard, version=i + 1
                )
                up, down = (0.85, 0.15) if heard == "hear_left" else (0.15, 0.85)
                left = left * up / (left * up + (1 - left) * down)
                now = dict(
                    zip(
                        *[
                            getattr(services.get_belief(belief_id=name), f)
                            for f in ("states", "belief")
                        ]
                    )
                )
                if response.status.code != Status.OK or abs(now.get(0, 0.0) - left) > 1e-9:
                    failures.append((seed, i, response.status.message, now, left))

        def plan():
            response = self.services.plan_online(
                policy_id=policy, time_limit=rospy.Duration(0.5), num_scenarios=50
            )
            if response.status.code != Status.OK:
                failures.append(response.status.message)

        threads = [threading.Thread(target=follow, args=(seed,)) for seed in range(1, 5)]
        threads.append(threading.Thread(target=plan))
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        running.cancel()
        self.assertEqual(running.result().status.code, Status.OK)


if __name__ == "__main__":
    rospy.init_node("policy_node_services_test")
    rostest.rosrun("kr3_pomdp", "policy_node_services_test", PolicyNodeServicesTest)
