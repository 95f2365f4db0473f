// Those parts of Boost.Asio and Boost.Beast that are no templates: compiled once, here
// (BOOST_ASIO_SEPARATE_COMPILATION), not in each file that uses them.
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>
#ifdef ALIDADE_TLS
#include <boost/asio/ssl/impl/src.hpp>
#endif
