#pragma once

#include <filesystem>
#include <string_view>

#include "sim/contact/contact_source.hpp"

namespace hapbench {

/// Reads a trace of contacts from the contents of a CSV file with the header time_s,x_m,y_m,z_m,ux,uy,uz,depth_m, a row
/// for each contact. Times must not fall, depths must not be below 0, and gradients must have length 1 within 0.001;
/// those further off than rounding are normalised, others stay as they are, bit for bit. Throws InputError that names
/// the row, for more than 20 million contacts, and for more than 100 000 of one time.
ContactTrace trace_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
