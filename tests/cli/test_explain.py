def test_the_command_explains_lists_and_offers(imuwb):
    assert "0.664" in imuwb("explain", "bias", "instability").out
    assert "clock jump" in imuwb("explain").out
    wrong = imuwb("explain", "clok", "jump")
    assert (wrong.code, "clock jump" in wrong.err) == (2, True)
