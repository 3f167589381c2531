#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "scenarios/format/input_error.hpp"

namespace hapbench::test {

/// The InputError that `work` throws; none, and a failed test, when it throws nothing. Other exceptions go through.
template <class Work>
std::optional<InputError> input_error_of(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return std::nullopt;
}

}  // namespace hapbench::test
