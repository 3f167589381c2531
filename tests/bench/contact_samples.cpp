#include "tests/bench/contact_samples.hpp"

#include <algorithm>
#include <stdexcept>

#include "algorithms/depth/depth_model.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "tests/bench/task_scene.hpp"

namespace hapbench::bench {

namespace {

/// Calls take(contacts) at every so many poses of a task, until it returns false.
template <class Take>
void for_contacts(const std::string& task, std::size_t every, Take take) {
  const TaskScene& scene = task_scene(task);
  GridQuery query(*scene.shell, *scene.tool);
  const auto depth_model = make_depth_model("surface_normal");
  ContactBuffer here(query.capacity());
  for (std::size_t k = 0; k < scene.poses.size(); k += every) {
    query.contacts_at(scene.poses[k], here);
    depth_model->evaluate(*scene.tool, scene.poses[k], here);
    if (!take(here)) return;
  }
}

}  // namespace

ContactBuffer task_contacts(std::size_t n) {
  constexpr std::size_t kEvery = 205;  // 0.1 s
  ContactBuffer sample(n);
  for_contacts("T2", kEvery, [&](const ContactBuffer& here) {
    for (std::size_t i = 0; i < here.size() && sample.size() < n; ++i) sample.push_copy_of(here, i);
    return sample.size() < n;
  });
  if (sample.size() < n) throw std::logic_error("T2 has too few contacts for this benchmark");
  sample.pad();
  return sample;
}

ContactBuffer repeated_contacts(std::size_t n) {
  const ContactBuffer base = task_contacts(std::min(n, kRepeated));
  ContactBuffer sample(n);
  for (std::size_t i = 0; i < n; ++i) sample.push_copy_of(base, i % base.size());
  sample.pad();
  return sample;
}

std::vector<ContactBuffer> contacts_along(const std::string& task) {
  constexpr std::size_t kEvery = 64;
  std::vector<ContactBuffer> samples;
  for_contacts(task, kEvery, [&samples](const ContactBuffer& here) {
    samples.emplace_back(std::max<std::size_t>(1, here.size()));
    samples.back().assign(here);
    return true;
  });
  return samples;
}

}  // namespace hapbench::bench
