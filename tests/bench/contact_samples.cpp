#include "tests/bench/contact_samples.hpp"

#include <stdexcept>

#include "algorithms/depth/surface_normal.hpp"
#include "sim/contact/grid_query.hpp"
#include "tests/bench/task_scene.hpp"

namespace hapbench::bench {

ContactBuffer task_contacts(std::size_t n) {
  constexpr std::size_t kEvery = 205;  // 0.1 s
  const TaskScene& scene = task_scene("T2");
  GridQuery query(*scene.shell, *scene.tool);
  const auto depth_model = make_surface_normal();
  ContactBuffer here(query.capacity()), sample(n);
  for (std::size_t k = 0; k < scene.poses.size() && sample.size() < n; k += kEvery) {
    query.contacts_at(scene.poses[k], here);
    depth_model->evaluate(*scene.tool, scene.poses[k], here);
    for (std::size_t i = 0; i < here.size() && sample.size() < n; ++i) sample.push_copy_of(here, i);
  }
  if (sample.size() < n) throw std::logic_error("T2 has too few contacts for this benchmark");
  sample.pad();
  return sample;
}

}  // namespace hapbench::bench
