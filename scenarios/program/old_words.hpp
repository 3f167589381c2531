#pragma once

#include <string>

namespace hapbench {

/// Throws an InputError that says what to write instead of a word that earlier versions took: of a command, or with
/// `command` of one of its options, which may have a value as NAME=VALUE.
void refuse_old_word(const std::string& command, const std::string& word);

}  // namespace hapbench
