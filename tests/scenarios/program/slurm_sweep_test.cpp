#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <stdexcept>
#include <thread>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// Sweeps on a real Slurm.
namespace hapbench::slurm_sweep_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;
using Words = std::vector<std::string>;

/// The file of a program of the system; empty when there is none.
fs::path file_of(const std::string& program) {
  for (const char* folder : {"/usr/bin", "/usr/sbin"}) {
    if (fs::exists(fs::path(folder) / program)) return fs::path(folder) / program;
  }
  return {};
}

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return std::string(name).substr(0, std::string(name).find('.'));
}

/// Jobs run as root: nobody else is to submit any.
std::string secret() {
  std::random_device random;
  std::string key(128, '\0');
  for (char& byte : key) byte = static_cast<char>(random());
  return key;
}

/// A port that nobody listens on now.
int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::socklen_t size = sizeof address;
  ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(socket);
  return ntohs(address.sin_port);
}

/// A Slurm cluster of one node with four CPUs, this machine, with daemons, ports, key and folder of its own; while it
/// lives the environment names it (SLURM_CONF), and with it the daemons go, also when the test is killed.
class SlurmCluster {
 public:
  /// Names what is missing to start one; empty when nothing is.
  static std::string missing();

  /// Precondition: nothing is missing. Throws std::runtime_error when the daemons do not answer.
  SlurmCluster();
  /// Cancels what still runs.
  ~SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  /// Runs one of Slurm's commands.
  ProgramRun operator()(const std::string& command, const std::vector<std::string>& arguments) const;

  /// The logs of the daemons, for a test that failed.
  std::string logs() const;

 private:
  void write_configuration() const;
  void start(const std::vector<std::string>& words);

  test::TemporaryDirectory directory_;
  std::vector<std::unique_ptr<test::RunningProgram>> daemons_;
};

std::string SlurmCluster::missing() {
  for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "setpriv"}) {
    if (file_of(program).empty()) return std::string(program) + " (scripts/setup --tests installs it)";
  }
  if (::geteuid() != 0) return "the rights of root, which the daemons need to start jobs";
  if (::getpwnam("munge") == nullptr) return "a user munge";
  return "";
}

SlurmCluster::SlurmCluster() {
  write_configuration();
  ::setenv("SLURM_CONF", (directory_ / "slurm.conf").c_str(), 1);
  const std::string munge = directory_ / "munge";
  start({"--reuid=munge", "--regid=munge", "--clear-groups", file_of("munged"), "--foreground",
         "--socket=" + munge + "/socket", "--key-file=" + munge + "/key", "--pid-file=" + munge + "/pid",
         "--seed-file=" + munge + "/seed", "--log-file=" + munge + "/log"});
  start({file_of("slurmctld"), "-D", "-i", "-L", directory_ / "slurmctld.log"});
  start({file_of("slurmd"), "-D", "-L", directory_ / "slurmd.log"});
  for (int attempt = 0; attempt < 1000; ++attempt) {
    if ((*this)("sinfo", {"--noheader", "--format=%T"}).out == "idle\n") return;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  throw std::runtime_error("the daemons of Slurm do not answer:\n" + logs());
}

SlurmCluster::~SlurmCluster() {
  (*this)("scancel", {"--full", "--signal=KILL", "--user=root"});
  daemons_.clear();
  ::unsetenv("SLURM_CONF");
}

ProgramRun SlurmCluster::operator()(const std::string& command, const std::vector<std::string>& arguments) const {
  return test::run_program(file_of(command), arguments);
}

/// Each daemon is killed when this process ends, however it ends.
void SlurmCluster::start(const std::vector<std::string>& words) {
  std::vector<std::string> all = {"--pdeathsig=KILL"};
  all.insert(all.end(), words.begin(), words.end());
  daemons_.push_back(std::make_unique<test::RunningProgram>(file_of("setpriv"), all));
}

void SlurmCluster::write_configuration() const {
  const fs::path munge = directory_ / "munge";
  for (const char* folder : {"munge", "state", "spool"}) fs::create_directory(directory_ / folder);
  test::write_plainly(munge / "key", secret());
  const ::passwd* user = ::getpwnam("munge");
  for (const fs::path& path : {munge, munge / "key"}) {
    if (::chown(path.c_str(), user->pw_uid, user->pw_gid) != 0) throw std::runtime_error("cannot give to munge");
  }
  fs::permissions(munge / "key", fs::perms::owner_read);
  for (const fs::path& path : {directory_.path(), munge}) {
    fs::permissions(path, fs::perms::owner_all | fs::perms::group_exec | fs::perms::others_exec |
                              fs::perms::group_read | fs::perms::others_read);
  }
  test::write_plainly(directory_ / "cgroup.conf", "CgroupPlugin=cgroup/v1\n");
  const std::string host = host_name(), here = directory_.path();
  test::write_plainly(
      directory_ / "slurm.conf",
      "ClusterName=hapbench\nSlurmctldHost=" + host + "(127.0.0.1)\nSlurmctldPort=" + std::to_string(free_port()) +
          "\nSlurmdPort=" + std::to_string(free_port()) +
          "\nSlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\nAuthInfo=socket=" + here +
          "/munge/socket\nStateSaveLocation=" + here + "/state\nSlurmdSpoolDir=" + here +
          "/spool\nSlurmctldPidFile=" + here + "/slurmctld.pid\nSlurmdPidFile=" + here +
          "/slurmd.pid\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n"
          "JobAcctGatherType=jobacct_gather/none\nMpiDefault=none\nSwitchType=switch/none\n"
          "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\nReturnToService=2\n"
          "SchedulerParameters=batch_sched_delay=0,sched_min_interval=0\n"
          // As many as the test wants to run at once, whatever the machine has.
          "SlurmdParameters=config_overrides\nNodeName=" +
          host + " NodeAddr=127.0.0.1 CPUs=4 RealMemory=100 State=UNKNOWN\nPartitionName=main Nodes=" + host +
          " Default=YES MaxTime=INFINITE State=UP\n");
}

std::string SlurmCluster::logs() const {
  std::string text;
  for (const char* log : {"munge/log", "slurmctld.log", "slurmd.log"}) {
    if (fs::exists(directory_ / log)) text += test::read_file(directory_ / log);
  }
  return text;
}

class SlurmSweep : public testing::Test {
 protected:
  void SetUp() override {
    const std::string missing = SlurmCluster::missing();
    if (!missing.empty()) GTEST_SKIP() << "no Slurm to test with, for want of " << missing;
    slurm_ = std::make_unique<SlurmCluster>();
  }

  /// Runs of some 20 ms.
  Words words(const std::string& out, const Words& more = {}) const {
    Words words = {"sweep",  "single_spring",
                   "--set",  "record.trajectory=false",
                   "--set",  "time.steps=100000",
                   "--vary", "rendering.stiffness_N_per_m=1e3:1e4:" + std::to_string(runs_) + ":log",
                   "--out",  (directory_ / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Json status() const { return hapbench({"sweep", "--status", (directory_ / "out").string(), "--json"}).json(); }
  std::string state(std::size_t shard) const { return status()["shards"][shard]["state"]; }

  /// Waits, however long it takes.
  template <class Condition>
  static void wait_until(Condition is_so) {
    while (!is_so()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  void wait_for(std::size_t shard, const std::string& wanted) const {
    wait_until([&] { return state(shard) == wanted; });
  }
  void wait_for_the_queue_to_empty() const {
    wait_until([&] { return (*slurm_)("squeue", {"--noheader"}).out.empty(); });
  }
  /// Submits three shards, kills shard 1 and has Slurm stop and requeue shard 0, as preemption does, once both have
  /// begun. Returns false when one of them ended before.
  bool submit_kill_and_requeue() const {
    const ProgramRun first = hapbench(words("out", {"--slurm", "3"}));
    EXPECT_EQ(first.status, 0) << first.err;
    EXPECT_NE(first.out.find("3 of 3 shards submitted as job "), std::string::npos) << first.out;
    wait_until([&] {
      const Json shards = status()["shards"];
      return shards[0]["runs_done"] >= 2 && shards[1]["runs_done"] >= 2;
    });
    const pid_t process = process_of("1/3");
    return process != 0 && process_of("0/3") != 0 && ::kill(process, SIGKILL) == 0 &&
           (*slurm_)("scontrol", {"requeue", array() + "_0"}).status == 0;
  }
  std::string array() const { return Json::parse(test::read_file(directory_ / "out/sweep_slurm.json"))["array"]; }

  std::string log_of_shard(const std::string& shard) const {
    return test::read_file(directory_ / "out" / ("slurm_shard_" + shard + ".log"));
  }

  /// The process that computes a shard into this test's directory; 0 for none.
  pid_t process_of(const std::string& shard) const {
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
      std::ifstream in(entry.path() / "cmdline", std::ios::binary);
      const std::string words((std::istreambuf_iterator<char>(in)), {});
      const bool is_it = words.starts_with(test::hapbench_program().string()) &&
                         words.find((directory_ / "out").string()) != std::string::npos &&
                         words.find('\0' + shard + '\0') != std::string::npos;
      if (is_it) return std::stoi(entry.path().filename());
    }
    return 0;
  }

  int runs_ = 120;
  test::TemporaryDirectory directory_;
  std::unique_ptr<SlurmCluster> slurm_;
};

TEST_F(SlurmSweep, WithAShardKilledAndOnePreemptedEndsWithTheBytesOfOneMachine) {
  // With more runs, a busy machine leaves time to interrupt them.
  for (; !submit_kill_and_requeue(); runs_ *= 4) {
    wait_for_the_queue_to_empty();
    fs::remove_all(directory_ / "out");
  }
  wait_for(1, "failed");
  wait_for(0, "waiting");
  const ProgramRun early = hapbench(words("out", {"--slurm", "3"}));
  EXPECT_EQ(early.status, 2);
  EXPECT_NE(early.err.find("is still in the queue; allowed: when it has ended"), std::string::npos) << early.err;

  // It would wait for two minutes. In the second in which it was stopped, Slurm would refuse to start it again ("Job
  // credential revoked").
  EXPECT_EQ((*slurm_)("scontrol", {"update", "JobId=" + array() + "_0", "StartTime=now+2seconds"}).status, 0);
  wait_for(0, "done");
  wait_for(2, "done");
  EXPECT_EQ(state(1), "failed");
  EXPECT_FALSE(fs::exists(directory_ / "out/sweep.csv")) << "merged without shard 1";
  wait_for_the_queue_to_empty();

  const ProgramRun second = hapbench(words("out", {"--slurm", "3"}));
  EXPECT_NE(second.out.find("1 of 3 shards submitted as job "), std::string::npos) << second.out << second.err;
  wait_until([&] { return status()["merged"] == true; });
  EXPECT_EQ(status()["done"], 3);
  ASSERT_EQ(hapbench(words("whole")).status, 0);
  for (const char* file : {"sweep.csv", "sweep.json"}) {
    EXPECT_EQ(test::read_file(directory_ / "out" / file), test::read_file(directory_ / "whole" / file)) << file;
  }
}

TEST_F(SlurmSweep, ThatSlurmRefusesSaysWhy) {
  const ProgramRun run = hapbench(words("out", {"--slurm", "3", "--partition", "none_such"}));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("invalid partition specified: none_such"), std::string::npos) << run.err;
  EXPECT_EQ(test::lines_of(run.err).size(), 1u) << run.err;
}

}  // namespace
}  // namespace hapbench::slurm_sweep_test
