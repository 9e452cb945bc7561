// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who may talk to the server, and what clients cannot do to it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <ctime>
#include <memory>
#include <thread>
#include <vector>

#include "kernel/live/live_server.hpp"
#include "tests/live/client.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

LivePicture picture(std::uint64_t surface, std::size_t bytes = 64) {
  const auto message = [&](const std::string& kind) {
    std::string head = R"({"kind":")" + kind + R"(","surface":)" + std::to_string(surface) + "}";
    head.resize((head.size() + 3) / 4 * 4, ' ');
    const auto length = static_cast<std::uint32_t>(head.size());
    std::string text(reinterpret_cast<const char*>(&length), 4);
    return std::make_shared<const std::string>(text + head + std::string(bytes, '\0'));
  };
  return {surface, message("surface"), message("state")};
}

class Server : public testing::Test {
 protected:
  std::vector<std::string> wait_for_inputs() {
    std::vector<std::string> inputs;
    for (int i = 0; i < 200 && inputs.empty(); ++i) {
      server->wait(50ms);
      inputs = server->take_inputs();
    }
    return inputs;
  }
  bool wait_for_want(bool wants) {
    for (int i = 0; i < 1000 && server->wants_picture() != wants; ++i)
      std::this_thread::sleep_for(10ms);
    return server->wants_picture() == wants;
  }

  std::unique_ptr<LiveServer> server = open_live_server(0);
  Address address{server->address()};
};

TEST_F(Server, ServesThePageToWhoHasTheToken) {
  EXPECT_EQ(address.path.size(), 34U);
  EXPECT_THAT(Client(address).get(address.path).text, HasSubstr("<canvas"));
  EXPECT_EQ(Client(address).get(address.path + "three/build/three.module.js").status, 200U);
  EXPECT_EQ(Client(address).get("/").status, 403U);
  std::string wrong = address.path;
  wrong[5] = wrong[5] == '0' ? '1' : '0';
  EXPECT_EQ(Client(address).get(wrong).status, 403U);
  EXPECT_EQ(Client(address).get(address.path.substr(0, 10) + "/").status, 403U);
  EXPECT_EQ(Client(address).get(address.path + "nothing.js").status, 404U);
  EXPECT_EQ(Client(address).get(address.path + "three/../../../../etc/passwd").status, 404U);
  EXPECT_EQ(Client(address).get(address.path + "three/../three/build/three.module.js").status,
            404U);
}

// A name of another site that resolves to this machine.
TEST_F(Server, RefusesOtherHostsAndOrigins) {
  EXPECT_EQ(Client(address).get(address.path, "evil.example:80").status, 403U);
  EXPECT_EQ(Client(address).get(address.path, "localhost:1234").status, 200U);
  const std::string socket = address.path + "socket";
  EXPECT_FALSE(Client(address).open(socket, "http://evil.example"));
  EXPECT_FALSE(Client(address).open(socket, "http://localhost:" + address.port));
  EXPECT_FALSE(Client(address).open("/0123456789abcdef0123456789abcdef/socket"));
  EXPECT_TRUE(Client(address).open(socket, "http://" + address.host()));
}

TEST_F(Server, LetsOnePageControlAndTheOthersWatch) {
  server->greet(R"({"live":1})");
  Client first(address), second(address);
  ASSERT_TRUE(first.open());
  EXPECT_EQ(first.next(), Json::parse(R"({"live":1})"));
  EXPECT_EQ(first.next()["control"], true);
  ASSERT_TRUE(second.open());
  EXPECT_EQ(second.until("control")["control"], false);
  second.send("from the second");
  EXPECT_THAT(second.until("error")["error"], HasSubstr("another page"));
  first.send("from the first");
  EXPECT_THAT(wait_for_inputs(), testing::ElementsAre("from the first"));
  first.vanish();
  EXPECT_EQ(second.until("control")["control"], true);
  second.send("from the second");
  EXPECT_THAT(wait_for_inputs(), testing::ElementsAre("from the second"));
}

TEST_F(Server, SendsTrianglesOnlyWhereTheyChanged) {
  Client page(address);
  ASSERT_TRUE(page.open());
  page.until("control");
  ASSERT_TRUE(wait_for_want(true));
  std::string kinds;
  for (const std::uint64_t surface : {1, 1, 2, 2}) {
    server->show(picture(surface));
    for (Json head; head["kind"] != "state"; kinds += head["kind"].get<std::string>() + " ")
      head = page.next();
  }
  EXPECT_EQ(kinds, "surface state state surface state state ");
  Client late(address);
  ASSERT_TRUE(late.open());
  EXPECT_EQ(late.until("kind")["kind"], "surface");
  EXPECT_EQ(late.next()["surface"], 2);
}

// What a page has not drawn is not sent again and again, and what it does not read is not kept.
TEST_F(Server, GivesASlowPageFewerPictures) {
  Client slow(address);
  ASSERT_TRUE(slow.open());
  ASSERT_TRUE(wait_for_want(true));
  for (std::uint64_t i = 1; i <= 200; ++i) server->show(picture(i, 1 << 20));
  ASSERT_TRUE(wait_for_want(false));
  Client fast(address);
  ASSERT_TRUE(fast.open());
  EXPECT_EQ(fast.until("kind")["surface"], 200);
  ASSERT_TRUE(wait_for_want(true));
  server->show(picture(201));
  while (fast.until("kind")["surface"] != 201) continue;
  slow.until("control");
  std::vector<std::uint64_t> seen;
  while (seen.empty() || seen.back() != 201) seen.push_back(slow.until("kind")["surface"]);
  EXPECT_LE(seen.size(), 8U);
}

TEST_F(Server, CutsOffWhoNeverReads) {
  Client silent(address), other(address);
  ASSERT_TRUE(silent.open());
  ASSERT_TRUE(other.open());
  EXPECT_EQ(other.until("control")["control"], false);
  const std::string text = R"({"message":")" + std::string(10000, 'x') + "\"}";
  int texts = 0;
  for (Json heard; !heard.contains("control"); heard = other.next()) {
    server->say(text);
    ASSERT_LT(++texts, 3000);
  }
}

TEST_F(Server, SurvivesGarbage) {
  Client page(address);
  ASSERT_TRUE(page.open());
  for (int i = 0; i < 100; ++i) page.send_bytes(std::string(static_cast<std::size_t>(i), '\xff'));
  page.send(std::string(60000, '{'));
  EXPECT_EQ(wait_for_inputs().size(), 1U);
  try {
    page.send(std::string(1 << 20, 'x'));  // too long: it is cut off
    for (;;) page.read();
  } catch (const boost::system::system_error&) {
  }
  Client next(address);
  ASSERT_TRUE(next.open());
  EXPECT_EQ(next.until("control")["control"], true);
  EXPECT_TRUE(server->take_inputs().empty());
}

// Whoever says nothing makes room for others.
TEST_F(Server, ManyThatSayNothingKeepNobodyOut) {
  Client page(address);
  ASSERT_TRUE(page.open());
  std::vector<std::unique_ptr<Client>> silent;
  for (int i = 0; i < 200; ++i) silent.push_back(std::make_unique<Client>(address));
  EXPECT_THAT(Client(address).get(address.path).text, HasSubstr("<canvas"));
  EXPECT_THROW(silent.front()->get(address.path), boost::system::system_error) << "was cut off";
  page.send("from the page");
  EXPECT_THAT(wait_for_inputs(), testing::ElementsAre("from the page"));
}

TEST_F(Server, CutsOffWhoSaysNothingForLong) {
  Client silent(address);
  std::this_thread::sleep_for(7s);
  EXPECT_THROW(silent.get(address.path), boost::system::system_error);
}

// A connection that cannot be accepted stays in line: it must not keep the server busy.
TEST_F(Server, RestsWhileNoDescriptorIsLeft) {
  EXPECT_EQ(Client(address).get(address.path).status, 200U);
  boost::asio::io_context context;
  boost::asio::ip::tcp::socket waiting(context, boost::asio::ip::tcp::v4());
  std::vector<int> taken;
  for (int fd = ::open("/dev/null", O_RDONLY); fd >= 0; fd = ::dup(taken.front()))
    taken.push_back(fd);
  ASSERT_FALSE(taken.empty());
  waiting.connect({boost::asio::ip::address_v4::loopback(),
                   static_cast<unsigned short>(std::stoul(address.port))});
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(1s);
  const double busy = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  for (const int fd : taken) ::close(fd);
  EXPECT_LT(busy, 0.2);
  EXPECT_EQ(Client(address).get(address.path).status, 200U);
}

// All addresses of this machine, by any of its names; the token and the origin are needed as ever.
TEST(Listening, IsOpenToOtherMachinesOnRequest) {
  const auto server = open_live_server(0, "0.0.0.0");
  Address address("http://127.0.0.1" + server->address().substr(server->address().rfind(':')));
  EXPECT_EQ(Client(address).get(address.path, "lab.example:80").status, 200U);
  EXPECT_EQ(Client(address).get("/", "lab.example:80").status, 403U);
  EXPECT_FALSE(Client(address).open(address.path + "socket", "http://evil.example"));
  EXPECT_TRUE(Client(address).open(address.path + "socket", "http://" + address.host()));
}

TEST(Listening, NamesAnAddressThatIsNotOfThisMachine) {
  for (const char* host : {"192.0.2.1", "nonsense"}) {
    try {
      open_live_server(0, host);
      FAIL();
    } catch (const std::exception& error) {
      EXPECT_THAT(error.what(), HasSubstr("any port of '" + std::string(host) + "'"));
      EXPECT_THAT(error.what(), HasSubstr("--host"));
    }
  }
}

TEST(Listening, SaysWhenAPortIsTaken) {
  const auto first = open_live_server(0);
  const auto port = static_cast<std::uint16_t>(std::stoul(Address(first->address()).port));
  try {
    open_live_server(port);
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot listen on port " + std::to_string(port)));
  }
}

}  // namespace
}  // namespace suture::test
