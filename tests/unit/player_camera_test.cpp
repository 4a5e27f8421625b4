// SPDX-License-Identifier: Apache-2.0
// The player's cameras: framing a scene, finding one in a pack, flying.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "pack_sample.h"
#include "player/camera.h"

namespace chandelier::player {
namespace {

void expect_orthonormal(const Camera& camera) {
  EXPECT_NEAR(glm::length(camera.forward_ws), 1.0f, 1e-5f);
  EXPECT_NEAR(glm::length(camera.up_ws), 1.0f, 1e-5f);
  EXPECT_NEAR(glm::dot(camera.forward_ws, camera.up_ws), 0.0f, 1e-5f);
}

std::string error_choosing(const pack::File& pack, const std::string& name) {
  try {
    choose_camera(pack, name, 1.0f);
    return "none";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(PlayerCamera, LooksAlongEveryDirectionUpright) {
  for (const glm::vec3 target : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(-3, 2, 5)}) {
    const Camera camera = camera_looking_at(glm::vec3(0.0f), target, 1.0f);
    expect_orthonormal(camera);
    EXPECT_GE(camera.up_ws.y, -1e-6f);
    EXPECT_NEAR(glm::dot(camera.forward_ws, glm::normalize(target)), 1.0f, 1e-6f);
  }
}

TEST(PlayerCamera, NumbersThatArePrintedLookTheSameWay) {
  pack::Contents contents;
  contents.bake_info.origin_m = {500000, 0, -250000.5};
  const pack::View pack = pack::view_of(contents);
  for (const float away_m : {0.0f, 9000.0f, 10000.0f, 100000.0f}) {
    const glm::vec3 eye(away_m + 0.25f, 1.7f, -0.5f * away_m);
    const Camera camera = camera_looking_at(eye, eye + glm::vec3(3, -1, 2), 0.8f);
    const auto read = camera_from_numbers(camera_numbers(pack, camera));
    ASSERT_TRUE(read) << away_m;
    const Camera again = in_world(*read, contents.bake_info.origin_m);
    EXPECT_GT(glm::dot(again.forward_ws, camera.forward_ws), 0.999999f) << away_m;
    EXPECT_LT(glm::distance(again.eye_ws, eye), 1e-4f + 2e-5f * away_m) << away_m;
  }
}

TEST(PlayerCamera, FramesAllCornersInWideAndTallPictures) {
  const glm::vec3 low(-2, 0, -7);
  const glm::vec3 high(4, 3, 1);
  for (const float aspect : {16.0f / 9.0f, 1.0f, 0.4f}) {
    const Camera camera = camera_framing(low, high, aspect);
    expect_orthonormal(camera);
    const glm::vec3 right = glm::cross(camera.forward_ws, camera.up_ws);
    const float tan_y = std::tan(0.5f * camera.yfov_rad);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 to(
          glm::vec3((corner & 1) ? high.x : low.x, (corner & 2) ? high.y : low.y, (corner & 4) ? high.z : low.z) -
          camera.eye_ws);
      const float depth = glm::dot(to, camera.forward_ws);
      EXPECT_GT(depth, camera.znear_m);
      EXPECT_LE(std::abs(glm::dot(to, camera.up_ws)), depth * tan_y);
      EXPECT_LE(std::abs(glm::dot(to, right)), depth * tan_y * aspect);
    }
  }
}

TEST(PlayerCamera, FramesAnEmptySceneWithoutNaN) {
  const Camera camera = camera_framing(glm::vec3(0.0f), glm::vec3(0.0f), 1.0f);
  expect_orthonormal(camera);
  EXPECT_GT(camera.znear_m, 0.0f);
}

TEST(PlayerCamera, ChoosesByNameOrTheFirstOrTheWholeScene) {
  pack::Contents contents = pack::test::sample();
  ASSERT_FALSE(contents.cameras.empty());
  const pack::test::Folder folder;
  pack::write(folder / "a.chandelier", contents);
  const pack::File with(folder / "a.chandelier");
  const std::string first(with.text(with.view().cameras[0].name));
  EXPECT_EQ(choose_camera(with, "", 1.0f).name, first);
  EXPECT_EQ(choose_camera(with, first, 1.0f).camera.eye_ws, contents.cameras[0].position_ws);
  EXPECT_EQ(error_choosing(with, "nowhere"), "--camera: the pack has " + first + ", none of that name (nowhere)");

  contents.cameras.clear();
  pack::write(folder / "b.chandelier", contents);
  const pack::File without(folder / "b.chandelier");
  EXPECT_EQ(choose_camera(without, "", 1.0f).name, "");
  EXPECT_EQ(error_choosing(without, "any"), "--camera: the pack has no cameras (any)");
}

TEST(PlayerCamera, TurnsRightAndUpAndStopsBeforeThePoles) {
  Camera camera;  // looks along -Z
  turn(camera, 1.5707963f, 0.0f);
  EXPECT_NEAR(camera.forward_ws.x, 1.0f, 1e-5f);
  turn(camera, 0.0f, 0.5f);
  EXPECT_NEAR(camera.forward_ws.y, std::sin(0.5f), 1e-5f);
  turn(camera, 0.0f, 10.0f);
  EXPECT_LT(camera.forward_ws.y, 1.0f);
  EXPECT_GT(camera.up_ws.y, 0.0f);
  expect_orthonormal(camera);
}

TEST(PlayerCamera, MovesAlongItsOwnAxesAndTheWorldsUp) {
  Camera camera;
  turn(camera, 1.5707963f, 0.0f);  // looks along +X: right is +Z
  move(camera, {1.0f, 2.0f, 3.0f});
  EXPECT_NEAR(camera.eye_ws.x, 3.0f, 1e-5f);
  EXPECT_NEAR(camera.eye_ws.y, 2.0f, 1e-5f);
  EXPECT_NEAR(camera.eye_ws.z, 1.0f, 1e-5f);
}

}  // namespace
}  // namespace chandelier::player
