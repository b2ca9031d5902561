// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/sdf_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace lidarena::world {
namespace {

std::string without_blanks(std::string text) {
  std::erase(text, ' ');
  return text;
}

TEST(WithoutUnseenElements, KeepsShapesAndPosesAndTheNumberOfEachLine) {
  const std::string text =
      "<world name='a'>\n<scene>\n<ambient>150 150 150 255</ambient>\n</scene>\n"
      "<model name='m'><pose>1 2 3 0 0 0</pose></model>\n</world>\n";
  const std::string kept = without_non_geometric_elements(text);
  EXPECT_EQ(kept.size(), text.size());
  EXPECT_EQ(without_blanks(kept),
            "<worldname='a'>\n\n\n\n<modelname='m'><pose>123000</pose></model>\n</world>\n");
}

TEST(WithoutUnseenElements, TakesEmptyOnesAndOnesWithinTheirOwnKind) {
  EXPECT_EQ(without_blanks(without_non_geometric_elements("<a><plugin name='x'/><b/></a>")),
            "<a><b/></a>");
  EXPECT_EQ(without_blanks(without_non_geometric_elements(
                "<a><plugin><plugin/><plugin>1</plugin></plugin ><b/></a>")),
            "<a><b/></a>");
}

TEST(WithoutUnseenElements, IsNotMisledByCommentsQuotesAndLongerNames) {
  for (const char* text : {"<a><!-- <scene> --><b/></a>", "<a><![CDATA[<scene>]]><b/></a>",
                           "<scenery><b/></scenery>", "<a title='<scene>'/>", "<plugins/>"}) {
    EXPECT_EQ(without_non_geometric_elements(text), text);
  }
  EXPECT_EQ(without_blanks(without_non_geometric_elements(
                "<a><scene><!-- </scene> --><c/><d e='</scene>'/></scene><b/></a>")),
            "<a><b/></a>");
}

TEST(WithoutUnseenElements, LeavesBrokenTextToTheParser) {
  for (const char* text :
       {"", "<", "<scene", "<scene>", "<a><scene><b></a>", "no markup", "<!-- "}) {
    EXPECT_EQ(without_non_geometric_elements(text), text);
  }
}

}  // namespace
}  // namespace lidarena::world
