#include "scenarios/batch/journal.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::journal_test {
namespace {

namespace fs = std::filesystem;
using Rows = std::vector<std::string>;

class JournalFile : public testing::Test {
 protected:
  /// The rows that a journal of the sweep finds.
  Rows resumed(const std::string& sweep = "mine") const {
    Rows rows;
    const Journal journal(file_, sweep, true, added_to(rows));
    return rows;
  }
  static Journal::Found added_to(Rows& rows) {
    return [&rows](Journal::Place, std::string_view row) { rows.emplace_back(row); };
  }
  /// A journal of these rows as a killed process leaves it; returns its bytes.
  std::string written(const Rows& rows) const {
    {
      Journal journal(file_, "mine", false);
      for (const std::string& row : rows) journal.add(row);
    }
    return test::read_file(file_);
  }
  test::TemporaryDirectory directory_;
  fs::path file_ = directory_ / "sweep.journal";
};

TEST_F(JournalFile, GivesItsRowsBackAndGoesOn) {
  written({"0,a", "2,b"});
  {
    Rows found;
    Journal journal(file_, "mine", true, added_to(found));
    EXPECT_EQ(found, (Rows{"0,a", "2,b"}));
    journal.add("1,c");
  }
  EXPECT_EQ(resumed(), (Rows{"0,a", "2,b", "1,c"}));
}

TEST_F(JournalFile, IsBegunAnewWithoutResume) {
  written({"0,a", "2,b"});
  written({"5,e"});
  EXPECT_EQ(resumed(), Rows{"5,e"});
}

TEST_F(JournalFile, IsBegunAnewWhenThereIsNone) {
  EXPECT_EQ(resumed(), Rows{});
  EXPECT_TRUE(fs::exists(file_));
}

TEST_F(JournalFile, CutShortAnywhereKeepsTheWholeLinesAndGoesOn) {
  const Rows rows = {"0,a", "1,bcd", "2,e"};
  const std::string whole = written(rows);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    test::write_plainly(file_, whole.substr(0, size));
    const std::size_t lines =
        static_cast<std::size_t>(std::count(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size), '\n'));
    Rows expected(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(lines == 0 ? 0 : lines - 1));
    {
      Rows found;
      Journal journal(file_, "mine", true, added_to(found));
      ASSERT_EQ(found, expected) << size;
      journal.add("7,next");
    }
    expected.push_back("7,next");
    ASSERT_EQ(resumed(), expected) << size;
  }
}

TEST_F(JournalFile, DamagedAnywhereGivesNoRowThatWasNotAdded) {
  const Rows rows = {"0,a", "1,bcd", "2,e"};
  const std::string whole = written(rows);
  for (std::size_t at = whole.find('\n') + 1; at < whole.size(); ++at) {
    for (const char byte : {'x', '\n', '\0'}) {
      std::string damaged = whole;
      if (damaged[at] == byte) continue;
      damaged[at] = byte;
      test::write_plainly(file_, damaged);
      const Rows found = resumed();
      ASSERT_LT(found.size(), rows.size()) << at;
      for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], rows[i]) << at;
    }
  }
}

TEST_F(JournalFile, HoldsWhatIsAddedBackUntilItIsFlushed) {
  Journal journal(file_, "mine", false);
  const std::string title = test::read_file(file_);
  journal.add("0,a");
  journal.add("1,b");
  EXPECT_EQ(test::read_file(file_), title);
  EXPECT_EQ(Journal::count_rows(file_), 0u);
  journal.flush();
  EXPECT_EQ(Journal::count_rows(file_), 2u);
}

TEST_F(JournalFile, FindsEachRowAtItsPlaceHoweverLong) {
  std::vector<Journal::Place> places;
  const Rows rows = {"0,a", "1," + std::string(100'000, 'b'), "2,", "3," + std::string(2048 - 16 - 4, 'c'), "4,e"};
  {
    Journal journal(file_, "mine", false);
    for (const std::string& row : rows) {
      places.push_back(journal.add(row));
      if (row[0] == '2') journal.flush();
    }
    journal.flush();
    for (std::size_t i = rows.size(); i-- > 0;) EXPECT_EQ(journal.row_at(places[i]), rows[i]);
  }
  std::vector<Journal::Place> found;
  Journal journal(file_, "mine", true, [&](Journal::Place place, std::string_view) { found.push_back(place); });
  EXPECT_EQ(found, places);
  EXPECT_EQ(journal.row_at(places[1]), rows[1]);
  EXPECT_THROW(journal.row_at(1'000'000), IoError);
}

TEST_F(JournalFile, TellsWhetherItIsBeingWritten) {
  EXPECT_FALSE(Journal::is_being_written(file_));
  {
    const Journal journal(file_, "mine", false);
    EXPECT_TRUE(Journal::is_being_written(file_));
  }
  EXPECT_FALSE(Journal::is_being_written(file_));
}

TEST_F(JournalFile, OfAnotherSweepIsRefusedAndLeftAlone) {
  const std::string whole = written({"0,a"});
  for (const char* text : {whole.c_str(), "\n", "something else\n", "hapbench sweep journal 2, theirs\n"}) {
    test::write_plainly(file_, text);
    const auto error = test::input_error_of([&] { resumed("theirs"); });
    ASSERT_TRUE(error);
    EXPECT_NE(std::string(error->what()).find(file_.string() + ": is not the journal of this sweep"), std::string::npos)
        << error->what();
    EXPECT_EQ(test::read_file(file_), text);
  }
}

TEST_F(JournalFile, InUseIsRefusedAndLeftAlone) {
  Journal journal(file_, "mine", false);
  journal.add("0,a");
  EXPECT_TRUE(test::input_error_of([&] { Journal(file_, "mine", false); }));
  EXPECT_TRUE(test::input_error_of([&] { Journal(file_, "mine", true); }));
  journal.add("1,b");
  journal.flush();
  EXPECT_NE(test::read_file(file_).find("1,b"), std::string::npos);
}

TEST_F(JournalFile, ThatIsNoFileIsRefused) {
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  EXPECT_TRUE(test::input_error_of([&] { resumed(); }));
  fs::remove(file_);
  fs::create_directory(file_);
  EXPECT_THROW(resumed(), IoError);
}

TEST_F(JournalFile, IsGoneWhenRemoved) {
  Journal journal(file_, "mine", false);
  journal.remove();
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(JournalFile, OnAFullDiskIsAnErrorThatNamesItAndKeepsWhatWasWritten) {
  Journal journal(file_, "mine", false);
  const test::FileSizeLimit limit(200);
  const std::string row = "0," + std::string(60, 'a');
  std::size_t added = 0;
  try {
    for (; added < 10; ++added) {
      journal.add(row);
      journal.flush();
    }
    ADD_FAILURE() << "no error";
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), file_);
  }
  EXPECT_EQ(added, 2u);  // 31 bytes of title and 80 of each row
}

}  // namespace
}  // namespace hapbench::journal_test
