#pragma once

#include <cstdint>

#include "sim/core/hash.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/simulation.hpp"

/// Bit-for-bit comparison, for claims that two results are identical: a tolerance would hide differences.
namespace hapbench::test {

/// Hash of the bits of numbers. Distinguishes -0 from 0, and different NaNs from each other.
class Hash {
 public:
  void add(std::uint64_t word) { hash_.word(word); }
  void add(double number) { hash_.real(number); }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      for (Eigen::Index i = 0; i < matrix.rows(); ++i) add(static_cast<double>(matrix(i, j)));
    }
  }
  void add(const ContactBuffer& contacts) {
    add(std::uint64_t{contacts.size()});
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      add(std::uint64_t{contacts.index[i]});
      add(contacts.point(i));
      add(contacts.normal(i));
      add(contacts.gradient(i));
      add(contacts.depth[i]);
      add(contacts.weight[i]);
    }
  }
  void add(const RenderedForce& force) {
    add(force.spring);
    add(force.rendered);
    add(force.S);
    add(force.depth_max);
  }
  void add(const StepRecord& record) {
    add(record.step);
    add(record.time);
    add(record.tool.pose.position);
    add(record.tool.pose.axis);
    add(record.tool.velocity);
    add(record.force);
    add(record.hand.measured);
    add(record.hand.input);
    add(record.handle.position);
    add(record.handle.velocity);
    add(std::uint64_t{record.colliding});
    add(*record.rendered);
    add(record.ratio.min);
    add(record.ratio.max);
  }
  std::uint64_t value() const { return hash_.value(); }

 private:
  Hash64 hash_;
};

/// Returns the hash of all arguments, in their order.
template <class... T>
std::uint64_t hash_of(const T&... values) {
  Hash hash;
  (hash.add(values), ...);
  return hash.value();
}

/// Hashes every step of a run. Requests the stiffness ratio, so that the hash includes it.
class HashingObserver final : public Observer {
 public:
  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override { hash_.add(record); }
  std::uint64_t value() const { return hash_.value(); }
  void clear() { hash_ = {}; }

 private:
  Hash hash_;
};

}  // namespace hapbench::test
