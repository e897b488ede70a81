// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/live_field_light.h"

#include <set>

#include "interface/dds_topics.h"
#include "render/live_news.h"
#include "render/say.h"

namespace lightwell::render {
namespace {

class LiveFieldLight final : public LightSource {
 public:
  LiveFieldLight(int domain, std::unique_ptr<FieldReader> reader)
      : reader_(std::move(reader)), news_("field light", domain) {}

  Result<bool> update(int /*frame*/, std::chrono::milliseconds wait) override {
    const bool arrived = reader_->take(frame_, wait);
    if (arrived) ++version_;
    news_.tell(reader_->age(), arrived, "'" + reader_->probe() + "'");
    // The words are a handful, whatever comes: a sender that goes on sending them is not said again.
    if (reader_->refused() > 0 && said_.insert(reader_->refusal()).second)
      say("a light field is refused: " + reader_->refusal());
    for (const std::string& name : reader_->contested())
      if (said_.insert(name).second)
        say("two publish a light field as '" + name +
            "': the first that was heard is shown, until it is silent for 2 s");
    return arrived;
  }

  [[nodiscard]] bool ready() const override { return version_ > 0; }
  [[nodiscard]] const LightField* field() const override { return version_ > 0 ? &frame_.field : nullptr; }
  [[nodiscard]] int field_version() const override { return version_; }
  [[nodiscard]] std::optional<std::chrono::nanoseconds> age() const override { return reader_->age(); }

 private:
  std::unique_ptr<FieldReader> reader_;
  FieldFrame frame_;  // the last good one
  int version_ = 0;
  LiveNews news_;
  std::set<std::string> said_;
};

}  // namespace

Result<std::unique_ptr<LightSource>> live_field_light(const DdsOptions& options) {
  auto domain = DdsDomain::open(options);
  if (!domain) return domain.error();
  auto reader = FieldReader::create(*domain);
  if (!reader) return reader.error();
  return std::unique_ptr<LightSource>(
      std::make_unique<LiveFieldLight>(options.domain, std::move(reader).value()));
}

}  // namespace lightwell::render
