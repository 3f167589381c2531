#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace hapbench {

/// Values that take long to make, shared by the runs of a process: parsed files, point shells, distance grids. For
/// several threads.
///
/// The values used last are kept, up to 64 of them and 512 MB. Twice as many as the machine has threads are kept in any
/// case, so that runs side by side do not take each other's away. A value that was dropped lives on while a run holds
/// it.
class SharedCache {
 public:
  /// The value of that key, which says all that the value depends on. It is made by `make`, which returns a
  /// std::shared_ptr<const T>, unless it is there; `bytes` of the value says about how large it is. Waits while another
  /// thread makes it. What `make` throws is passed on, and the next caller tries again.
  template <class T, class Make, class Bytes>
  std::shared_ptr<const T> get(const std::string& key, const Make& make, const Bytes& bytes) {
    return std::static_pointer_cast<const T>(get_untyped(key, [&]() -> Made {
      std::shared_ptr<const T> value = make();
      const std::size_t size = bytes(*value);
      return {std::move(value), size};
    }));
  }

  /// How many values have been made so far.
  std::size_t made() const;

 private:
  struct Made {
    std::shared_ptr<const void> value;
    std::size_t bytes = 0;
  };
  struct Entry {
    std::string key;
    std::mutex mutex;
    Made made;
  };
  static constexpr std::size_t kMost = 64;
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  std::shared_ptr<const void> get_untyped(const std::string& key, const std::function<Made()>& make);
  std::shared_ptr<Entry> entry_of(const std::string& key);
  /// Precondition: the list is locked.
  void drop_oldest();

  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< the one used last first
  std::size_t made_ = 0;
};

/// The one of this process.
SharedCache& shared_cache();

}  // namespace hapbench
