// SPDX-License-Identifier: Apache-2.0
// Error searches for frame after frame: waits for each view's answer, or goes on with the last one while a search runs
// in a thread.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "lights/error_search.h"

namespace chandelier {

/// Members of maps as an error search has chosen them; numbers are indices into the task's lights in view.
struct ErrorAnswer {
  std::vector<MapMember> members;
  bool is_current = true;  // false: of another view or world, as far as it fits
};

class ErrorDriven {
 public:
  /// `world` and `rays` must outlive this. `rays` must stand as the world does whenever something is asked; searches
  /// read a copy.
  ErrorDriven(const World& world, const rays::PackRays& rays, MeanMaterialsOf materials_of);
  ErrorDriven(const ErrorDriven&) = delete;
  ~ErrorDriven() { stop_.request_stop(); }  // and waits: running_ is the first to go

  /// The exact answer.
  std::vector<MapMember> select(const ErrorTask& task);
  /// Never waits: the exact answer where it is known, else the last one, and a search for this task begins as soon as
  /// no other runs. One for another task runs to its end, so that there are new answers while every frame asks for
  /// something else; where the exact answer is known it is stopped and its answer dropped. A light that the last answer
  /// does not know has a map of its own until then. Nothing where there is no answer yet.
  std::optional<ErrorAnswer> select_beside(const ErrorTask& task);
  /// A search that select_beside() began has ended, and nobody has taken its answer yet.
  bool has_news() const;

  /// estimated_rmse() of `members`, whose numbers are indices into `in_view`, read by `recipe.filter`.
  double expected_rmse(std::span<const LightId> in_view, std::span<const MapMember> members, const SampledView& view,
                       const Recipe& recipe);

 private:
  struct Found {
    std::shared_ptr<const ErrorTask> task;
    std::vector<MapMember> members;
  };
  bool knows(const ErrorTask& task) const;
  void stop();
  void follow_instances();
  void begin(const ErrorTask& task);

  const World& world_;
  const rays::PackRays& rays_;
  rays::PackRays searched_;  // as instances stood when the last search began. The thread's as search_ is
  Version instances_;        // that searched_ stand as
  SampledScene scene_;
  ErrorSearch search_;  // the thread's until running_ is ready
  std::optional<Found> last_;
  std::stop_source stop_;
  std::future<std::optional<Found>> running_;
};

}  // namespace chandelier
