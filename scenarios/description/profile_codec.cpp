#include "scenarios/description/profile_codec.hpp"

#include "scenarios/description/object.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {
namespace {

constexpr double kLargestValue = 1e9;

using Point = std::pair<double, double>;
using MovingShape = std::variant<Profile::Ramp, Profile::Sine, Profile::Waypoints>;

/// [time, value]
class PointCodec final : public Codec<Point> {
 public:
  explicit PointCodec(CodecPtr<double> value) : value_(std::move(value)) {}

  void read(const Json& json, const std::string& at, Point& out) const override {
    if (!json.is_array() || json.size() != 2) refuse(json, at, allowed());
    time_->read(json[0], element(at, 0), out.first);
    value_->read(json[1], element(at, 1), out.second);
  }
  Json write(const Point& value) const override { return {value.first, value.second}; }
  Json schema() const override {
    const Json items = {time_->schema(), value_->schema()};
    return {{"type", "array"}, {"items", items}, {"minItems", 2}, {"maxItems", 2}};
  }
  std::string allowed() const override { return "a pair [time in s, value]"; }

 private:
  CodecPtr<double> time_ = number({-kLargestValue, kLargestValue, "s"});
  CodecPtr<double> value_;
};

class InterpolationCodec final : public Codec<Profile::Interpolation> {
 public:
  void read(const Json& json, const std::string& at, Profile::Interpolation& out) const override {
    std::string name;
    name_->read(json, at, name);
    out = name == "cosine" ? Profile::Interpolation::cosine : Profile::Interpolation::linear;
  }
  Json write(const Profile::Interpolation& value) const override {
    return value == Profile::Interpolation::cosine ? "cosine" : "linear";
  }
  Json schema() const override { return name_->schema(); }
  std::string allowed() const override { return name_->allowed(); }

 private:
  CodecPtr<std::string> name_ = name_of({"linear", "cosine"}, "interpolation");
};

void check_times(const Profile::Waypoints& waypoints, const std::string& at) {
  const auto& points = waypoints.points;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i - 1].first < points[i].first) continue;
    throw InputError(InputError::Kind::relation, element(member(at, "points"), i),
                     "got time " + shown(points[i].first) + " after " + shown(points[i - 1].first) +
                         "; allowed: strictly increasing times");
  }
}

class ProfileCodec final : public Codec<Profile> {
 public:
  explicit ProfileCodec(const char* unit) : number_(number({-kLargestValue, kLargestValue, unit})) {
    auto ramp = object<Profile::Ramp>();
    ramp->required(
        "start", [](auto& r) -> double& { return r.start; }, number_, "value at t = 0");
    ramp->required(
        "rate_per_s", [](auto& r) -> double& { return r.rate_per_s; }, number_, "slope, per second");
    auto sine = object<Profile::Sine>();
    sine->required(
        "mean", [](auto& s) -> double& { return s.mean; }, number_, "m of m + a sin(2 pi t / T + phase)");
    sine->required(
        "amplitude", [](auto& s) -> double& { return s.amplitude; }, number_, "a");
    sine->required(
        "period_s", [](auto& s) -> double& { return s.period_s; }, number({0.0, kLargestValue, "s", true}), "T");
    sine->optional(
        "phase_rad", [](auto& s) -> double& { return s.phase_rad; }, number({-kLargestValue, kLargestValue, "rad"}),
        "phase at t = 0");
    auto waypoints = object<Profile::Waypoints>();
    waypoints->required(
        "points", [](auto& w) -> std::vector<Point>& { return w.points; },
        list_of<Point>(std::make_shared<PointCodec>(number_), 1, 1'000'000),
        "[t, v] pairs, t increasing; held constant outside");
    waypoints->optional(
        "interpolation", [](auto& w) -> Profile::Interpolation& { return w.interpolation; },
        CodecPtr<Profile::Interpolation>(std::make_shared<InterpolationCodec>()),
        "between the points: straight, or cosine (at rest in each point)");
    waypoints->relation(check_times);
    auto moving = tagged<MovingShape>("profile");
    moving->alternative("ramp", ramp).alternative("sine", sine).alternative("waypoints", waypoints);
    moving_ = moving;
  }

  void read(const Json& json, const std::string& at, Profile& out) const override {
    if (json.is_object()) {
      MovingShape shape;
      moving_->read(json, at, shape);
      out = std::visit([](auto& s) { return Profile(Profile::Shape(std::move(s))); }, shape);
      return;
    }
    if (!json.is_number()) refuse(json, at, allowed());
    double value = 0.0;
    number_->read(json, at, value);
    out = Profile(value);
  }

  Json write(const Profile& value) const override {
    return std::visit(
        [this](const auto& shape) -> Json {
          if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Profile::Constant>) {
            return shape.value;
          } else {
            return moving_->write(shape);
          }
        },
        value.shape());
  }

  Json schema() const override { return {{"anyOf", {number_->schema(), moving_->schema()}}}; }
  std::string allowed() const override { return number_->allowed() + ", or " + moving_->allowed(); }

 private:
  CodecPtr<double> number_;
  CodecPtr<MovingShape> moving_;
};

}  // namespace

CodecPtr<Profile> profile(const char* unit) {
  return std::make_shared<ProfileCodec>(unit);
}

}  // namespace hapbench
