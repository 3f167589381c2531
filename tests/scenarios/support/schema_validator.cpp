#include "tests/scenarios/support/schema_validator.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace hapbench::test {
namespace {

using valijson::adapters::NlohmannJsonAdapter;

/// Converts the document to valijson's JSON type, with whole numbers as integers.
nlohmann::json plain(const Json& json) {
  if (json.is_object()) {
    nlohmann::json object = nlohmann::json::object();
    for (const auto& entry : json.items()) object[entry.key()] = plain(entry.value());
    return object;
  }
  if (json.is_array()) {
    nlohmann::json array = nlohmann::json::array();
    for (const Json& entry : json) array.push_back(plain(entry));
    return array;
  }
  if (json.is_number_float()) {
    const double value = json.get<double>();
    if (value == std::floor(value) && std::abs(value) < 0x1p62) return static_cast<std::int64_t>(value);
    return value;
  }
  if (json.is_number_unsigned() && json.get<std::uint64_t>() > INT64_MAX) return json.get<double>();
  return json;
}

}  // namespace

struct SchemaValidator::Impl {
  nlohmann::json text;
  valijson::Schema schema;
};

SchemaValidator::SchemaValidator(const Json& schema) : impl_(std::make_unique<Impl>()) {
  impl_->text = nlohmann::json::parse(schema.dump());
  valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
  parser.populateSchema(NlohmannJsonAdapter(impl_->text), impl_->schema);
}

SchemaValidator::~SchemaValidator() = default;

bool SchemaValidator::accepts(const Json& document) const {
  const nlohmann::json target = plain(document);
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  return validator.validate(impl_->schema, NlohmannJsonAdapter(target), nullptr);
}

std::string SchemaValidator::complaints(const Json& document) const {
  const nlohmann::json target = plain(document);
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  valijson::ValidationResults results;
  validator.validate(impl_->schema, NlohmannJsonAdapter(target), &results);
  std::string text;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    for (const std::string& context : error.context) text += context;
    text += ": " + error.description + "\n";
  }
  return text;
}

}  // namespace hapbench::test
