#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace condyle {

/// Arrays of one length that are needed repeatedly. Returned ones are reused, because allocation
/// costs more than filling. Thread-safe.
template <class T>
class BufferPool {
  struct Shelf {
    std::mutex mutex;
    std::vector<std::unique_ptr<T[]>> arrays;
  };

 public:
  explicit BufferPool(std::size_t length) : shelf_(std::make_shared<Shelf>()), length_(length) {}

  struct GiveBack {
    std::shared_ptr<Shelf> shelf;
    void operator()(T* array) const {
      std::unique_ptr<T[]> owned(array);
      const std::lock_guard lock(shelf->mutex);
      shelf->arrays.push_back(std::move(owned));
    }
  };
  /// Returns to the pool on destruction; may outlive the pool.
  using Buffer = std::unique_ptr<T[], GiveBack>;

  /// Zeros when new, else with its last contents.
  Buffer take() const {
    {
      const std::lock_guard lock(shelf_->mutex);
      if (!shelf_->arrays.empty()) {
        Buffer buffer(shelf_->arrays.back().release(), GiveBack{shelf_});
        shelf_->arrays.pop_back();
        return buffer;
      }
    }
    return Buffer(std::make_unique<T[]>(length_).release(), GiveBack{shelf_});
  }
  std::size_t length() const { return length_; }
  /// Of the arrays that wait for their next use.
  std::size_t pooled_bytes() const {
    const std::lock_guard lock(shelf_->mutex);
    return shelf_->arrays.size() * length_ * sizeof(T);
  }

 private:
  std::shared_ptr<Shelf> shelf_;
  std::size_t length_;
};

}  // namespace condyle
