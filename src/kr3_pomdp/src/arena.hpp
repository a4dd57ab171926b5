#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace kr3::pomdp
{

/// A run of elements that lives elsewhere.
template <typename T>
class Slice
{
public:
  Slice(T* first, std::size_t size) : first_(first), size_(size) {}
  [[nodiscard]] T* begin() const { return first_; }
  [[nodiscard]] T* end() const { return first_ + size_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  T& operator[](std::size_t i) const { return first_[i]; }

private:
  T* first_;
  std::size_t size_;
};

/// Hands out runs of elements that stay where they are as long as the arena lives.
template <typename T>
class Arena
{
public:
  /// `count` elements, each T{}.
  T* allocate(std::size_t count)
  {
    if (used_ + count > size_)
    {
      size_ = std::max(count, kChunk);
      chunks_.push_back(std::make_unique<T[]>(size_));
      bytes_ += size_ * sizeof(T);
      used_ = 0;
    }
    T* const first = chunks_.back().get() + used_;
    used_ += count;
    return first;
  }
  [[nodiscard]] std::size_t sizeInBytes() const
  {
    return bytes_ + chunks_.capacity() * sizeof(chunks_.front());
  }

private:
  static constexpr std::size_t kChunk = (std::size_t{1} << 16U) / sizeof(T);
  std::vector<std::unique_ptr<T[]>> chunks_;
  std::size_t used_ = 0;
  std::size_t size_ = 0;  // of the last chunk
  std::size_t bytes_ = 0;
};

}  // namespace kr3::pomdp
