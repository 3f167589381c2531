#pragma once

namespace hapbench {

/// Lets InputError and IoError be raised as hapbench.ScenarioError and OSError.
void translate_errors();

}  // namespace hapbench
