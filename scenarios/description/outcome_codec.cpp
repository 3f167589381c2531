#include "scenarios/description/outcome_codec.hpp"

#include "results/summary/outcome_names.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {
namespace {

class OutcomesCodec final : public Codec<std::vector<std::string>> {
 public:
  void read(const Json& json, const std::string& at, std::vector<std::string>& out) const override {
    if (json.is_array()) return several_->read(json, at, out);
    std::string outcome;
    one_->read(json, at, outcome);
    out = {outcome};
  }
  Json write(const std::vector<std::string>& value) const override {
    return value.size() == 1 ? one_->write(value.front()) : several_->write(value);
  }
  Json schema() const override { return {{"anyOf", {one_->schema(), several_->schema()}}}; }
  std::string allowed() const override { return one_->allowed() + ", or a list of them"; }

 private:
  CodecPtr<std::string> one_ = name_of({outcome_names().begin(), outcome_names().end()}, "outcome");
  CodecPtr<std::vector<std::string>> several_ = list_of(one_, 1, 4);
};

}  // namespace

CodecPtr<std::vector<std::string>> outcomes() {
  return std::make_shared<OutcomesCodec>();
}

}  // namespace hapbench
