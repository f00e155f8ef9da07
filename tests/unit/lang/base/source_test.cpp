#include "lang/base/source.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace tf {
namespace {

TEST(Span, CoverIsTheSmallestSpanOfBoth) {
  EXPECT_EQ(cover({0, 3, 5}, {0, 8, 9}), (Span{0, 3, 9}));
  EXPECT_EQ(cover({0, 8, 9}, {0, 3, 5}), (Span{0, 3, 9}));
  EXPECT_EQ(cover({0, 1, 9}, {0, 3, 5}), (Span{0, 1, 9}));
}

TEST(Span, AnInvalidSpanIsNeutralAndFilesDoNotMix) {
  EXPECT_EQ(cover({}, {0, 3, 5}), (Span{0, 3, 5}));
  EXPECT_EQ(cover({0, 3, 5}, {}), (Span{0, 3, 5}));
  EXPECT_EQ(cover({0, 3, 5}, {1, 8, 9}), (Span{0, 3, 5}));
}

void expectPosition(const SourceFile &file, std::uint32_t offset, int line, int column) {
  const LineColumn position = file.lineColumn(offset);
  EXPECT_EQ(position.line, line) << "offset " << offset;
  EXPECT_EQ(position.column, column) << "offset " << offset;
}

TEST(SourceFile, LinesEndWithAnyOfTheThreeLineBreaks) {
  const SourceFile file("a.tf", "ab\ncd\r\nef\rgh");
  expectPosition(file, 0, 1, 1);
  expectPosition(file, 1, 1, 2);
  expectPosition(file, 3, 2, 1);
  expectPosition(file, 7, 3, 1);
  expectPosition(file, 10, 4, 1);
  expectPosition(file, 12, 4, 3);
  EXPECT_EQ(file.lineText(1), "ab");
  EXPECT_EQ(file.lineText(2), "cd");
  EXPECT_EQ(file.lineText(3), "ef");
  EXPECT_EQ(file.lineText(4), "gh");
}

TEST(SourceFile, ColumnsCountCodePoints) {
  const SourceFile file("a.tf", "\xC3\xA9 = \xE2\x82\xAC;");  // é = €;
  expectPosition(file, 2, 1, 2);
  expectPosition(file, 5, 1, 5);
  expectPosition(file, 8, 1, 6);
}

TEST(SourceFile, PlacesOutsideOfTheTextAreItsEnd) {
  const SourceFile file("a.tf", "ab\n");
  expectPosition(file, 99, 2, 1);
  EXPECT_EQ(file.lineText(2), "");
  EXPECT_EQ(file.lineText(0), "");
  EXPECT_EQ(file.lineText(7), "");
}

TEST(SourceManager, TextsKeepTheirAddress) {
  SourceManager sources;
  const FileId first = sources.add("a.tf", "x");
  const std::string_view text = sources.file(first).text();
  for (int i = 0; i < 1000; ++i)
    sources.add("b.tf", "y");
  EXPECT_EQ(text.data(), sources.file(first).text().data());
  EXPECT_EQ(sources.count(), 1001);
}

TEST(SourceManager, TextOfASpan) {
  SourceManager sources;
  const FileId file = sources.add("a.tf", "model A");
  EXPECT_EQ(sources.text({file, 6, 7}), "A");
  EXPECT_EQ(sources.text({file, 6, 70}), "A");
  EXPECT_EQ(sources.text({file, 60, 70}), "");
  EXPECT_EQ(sources.text({}), "");
}

TEST(SourceManager, LoadReadsFilesOnly) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "tf_source_test.tf";
  std::ofstream(path, std::ios::binary) << "model A\r\nend A;\n";
  SourceManager sources;
  const auto file = sources.load(path.string());
  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(sources.file(*file).text(), "model A\r\nend A;\n");
  std::filesystem::remove(path);
  EXPECT_FALSE(sources.load(path.string()).has_value());
  EXPECT_FALSE(sources.load(std::filesystem::temp_directory_path().string()).has_value());
}

}  // namespace
}  // namespace tf
