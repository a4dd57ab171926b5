#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

namespace kr3::pomdp
{

/// Services of a node. Each runs in the threads that serve the callback queue of its node handle,
/// several at a time.
class ServiceList
{
public:
  /// Offers a service: `answer` fills the response; what it throws becomes the status.
  template <typename Service>
  void offer(
      ros::NodeHandle& nh, const std::string& name,
      std::function<void(const typename Service::Request&, typename Service::Response&)> answer)
  {
    using Request = typename Service::Request;
    using Response = typename Service::Response;
    const boost::function<bool(Request&, Response&)> callback =
        [name, answer = std::move(answer), calls = calls_](const Request& request,
                                                           Response& response) {
      const UnderWay under_way(*calls);
      return respond(response.status, name, [&] {
        try
        {
          answer(request, response);
        }
        catch (const std::bad_alloc&)
        {
          throw ResourceExhausted("out of memory");
        }
      });
    };
    services_.push_back(nh.advertiseService(name, callback));
  }

  /// Offers nothing any more, and waits for the calls under way.
  /// @param patience_s  wall time to wait
  /// @return whether they have ended
  bool shutdown(double patience_s)
  {
    services_.clear();
    std::unique_lock<std::mutex> lock(calls_->mutex);
    return calls_->ended.wait_for(lock, std::chrono::duration<double>(patience_s),
                                  [this] { return calls_->count == 0; });
  }

private:
  struct Calls
  {
    std::mutex mutex;
    std::condition_variable ended;
    std::size_t count = 0;  // under way
  };

  /// Counts a call as long as it lives.
  class UnderWay
  {
  public:
    explicit UnderWay(Calls& calls) : calls_(calls)
    {
      const std::lock_guard<std::mutex> lock(calls_.mutex);
      ++calls_.count;
    }
    ~UnderWay()
    {
      const std::lock_guard<std::mutex> lock(calls_.mutex);
      --calls_.count;
      calls_.ended.notify_all();
    }
    UnderWay(const UnderWay&) = delete;
    UnderWay& operator=(const UnderWay&) = delete;

  private:
    Calls& calls_;
  };

  const std::shared_ptr<Calls> calls_ = std::make_shared<Calls>();
  std::vector<ros::ServiceServer> services_;
};

}  // namespace kr3::pomdp
