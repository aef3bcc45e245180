// Our marks are those of OpenCV's dictionary, bit by bit. Built only where OpenCV's ArUco module is installed: nothing
// else here needs it.
#include <gtest/gtest.h>

#include <opencv2/aruco.hpp>

#include "style/fiducials.h"

namespace scumble {
namespace {

TEST(OpenCvMarkers, AreOurs) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  for (int id = 0; id < kFiducialCount; ++id) {
    cv::Mat drawn;
    cv::aruco::drawMarker(dictionary, id, kFiducialModules, drawn, 1);
    for (int row = 0; row < kFiducialModules; ++row) {
      for (int column = 0; column < kFiducialModules; ++column) {
        EXPECT_EQ(FiducialIsBlack(id, column, row), drawn.at<unsigned char>(row, column) == 0) << id;
      }
    }
  }
}

}  // namespace
}  // namespace scumble
